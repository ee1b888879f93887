#include "report/record_trace.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "core/base/nan.hpp"
#include "core/daq/calibration.hpp"

namespace stickslip::report {
namespace {

/// \param value_of  of each row.
template <typename ValueOf>
RecordTrace trace_of(const record::Record& record, const ValueOf& value_of) {
  RecordTrace trace;
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  for (std::size_t i = 0; i < record.scan.size(); ++i) {
    const auto time_of = [&](base::ScanIndex scan) {
      return static_cast<double>(scan - record.scan.front()) / rate_Hz;
    };
    if (i > 0 && record.scan[i] != record.scan[i - 1] + 1) {
      trace.time_s.push_back(time_of(record.scan[i - 1] + 1));
      trace.value.push_back(base::kNaN);
    }
    trace.time_s.push_back(time_of(record.scan[i]));
    trace.value.push_back(value_of(i));
  }
  return trace;
}

}  // namespace

base::Result<RecordTrace> coefficient_trace(const record::Record& record) {
  if (record.header.board.quantity == daq::RawQuantity::kCounts && !record.header.load_cell) {
    return base::usage_error("the record has counts but no load cell, so no forces");
  }
  try {
    const daq::Calibration calibration{record.header.board, record.header.load_cell.value_or(daq::LoadCell{}),
                                       record.header.tester.tester().normal_load_N()};
    return trace_of(record, [&](std::size_t row) { return calibration.coefficient(record.raw[row]); });
  } catch (const std::invalid_argument& refused) {
    return base::usage_error("the record cannot be drawn: {}", refused.what());
  }
}

std::optional<RecordTrace> second_trace(const record::Record& record) {
  if (record.second.empty()) return std::nullopt;
  const daq::SecondChannel& channel = *record.header.board.second;
  return trace_of(record, [&](std::size_t row) { return channel.value(record.second[row]); });
}

RecordTrace derivative(const RecordTrace& trace, double factor) {
  RecordTrace slope;
  for (std::size_t i = 1; i < trace.time_s.size(); ++i) {
    const double step_s = trace.time_s[i] - trace.time_s[i - 1];
    slope.time_s.push_back(trace.time_s[i - 1] + step_s / 2.0);
    slope.value.push_back(factor * (trace.value[i] - trace.value[i - 1]) / step_s);
  }
  return slope;
}

std::optional<double> stretch_m(const record::Record& record) {
  const model::Tester tester = record.header.tester.tester();
  if (tester.stiffness_N_per_m && *tester.stiffness_N_per_m > 0.0) {
    return tester.normal_load_N() / *tester.stiffness_N_per_m;
  }
  if (!record.end || !record.end->truth) return std::nullopt;
  const model::TestTruth& truth = *record.end->truth;
  const double omega0 = truth.omega_rad_per_s * std::hypot(1.0, truth.gamma_over_2omega);  // [7]
  if (!(omega0 > 0.0)) return std::nullopt;
  return tester.gravity_m_per_s2 / (omega0 * omega0);
}

}  // namespace stickslip::report
