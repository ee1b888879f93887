#include "daemon/analyse.hpp"

#include <stdexcept>

#include "core/friction/test_analysis.hpp"
#include "daemon/method_text.hpp"

namespace stickslip::daemon {
namespace {

friction::AnalysisSettings settings_of(const record::Record& record, const daq::Calibration& calibration,
                                       const friction::Method& method) {
  friction::AnalysisSettings settings;
  settings.scan_rate_Hz = record.header.board.scan_rate_granted_Hz;
  settings.step_coefficient = calibration.step_coefficient();
  settings.tester = record.header.tester.tester();
  settings.method = method;
  return settings;
}

}  // namespace

base::Result<record::EndRecord> analyse(const record::Record& record) {
  if (record.header.board.quantity == daq::RawQuantity::kCounts && !record.header.load_cell) {
    return base::usage_error("the record has counts but no load cell, so no forces");
  }
  const base::Result<friction::Method> method = method_from_text(record.header.process.method);
  if (!method) return tl::unexpected(method.error());
  try {
    const daq::Calibration calibration{record.header.board, record.header.load_cell.value_or(daq::LoadCell{}),
                                       record.header.tester.tester().normal_load_N()};
    friction::TestAnalysis analysis{settings_of(record, calibration, *method)};
    // A jump of the index is a gap, as for the processor; the gaps stored tell only the cause.
    for (std::size_t i = 0; i < record.scan.size(); ++i) {
      if (i > 0 && record.scan[i] != record.scan[i - 1] + 1) {
        analysis.gap(record.scan[i - 1] + 1, record.scan[i] - record.scan[i - 1] - 1);
      }
      analysis.add(record.scan[i], calibration.coefficient(record.raw[i]),
                   calibration.saturated(record.raw[i]));
    }
    record::EndRecord end = record.end.value_or(record::EndRecord{});
    end.results = analysis.finish();
    end.cycles = analysis.cycles();
    end.spikes = analysis.spikes();
    return end;
  } catch (const std::invalid_argument& refused) {
    return base::usage_error("the record cannot be analysed: {}", refused.what());
  }
}

}  // namespace stickslip::daemon
