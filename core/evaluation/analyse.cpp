#include "core/evaluation/analyse.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/base/wording.hpp"
#include "core/pipeline/gain_uncertainty.hpp"
#include "core/pipeline/self_check.hpp"
#include "core/record/estimator_field.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/method_text.hpp"
#include "core/record/tester_file.hpp"

namespace stickslip::evaluation {
namespace {

analysis::AnalysisSettings settings_of(const record::RecordHeader& header,
                                       const daq::Calibration& calibration, const model::Method& method,
                                       detect::EstimatorTier estimator,
                                       const analysis::SkippedCorrections& skipped) {
  analysis::AnalysisSettings settings;
  settings.scan_rate_Hz = header.board.scan_rate_granted_Hz;
  settings.step_coefficient = calibration.step_coefficient();
  settings.tester = header.tester.tester();
  settings.method = method;
  settings.estimator = estimator;
  settings.skipped = skipped;
  return settings;
}

}  // namespace

pipeline::CalibrationInUse calibration_in_use(const std::optional<daq::LoadCell>& cell,
                                              const record::CalibrationFacts& facts) {
  if (!cell) return {};
  return {pipeline::relative_gain_uncertainty(cell, facts.gain_standard_error_N_per_V),
          daq::gain_change(cell->gain_N_per_V, facts.replaced_gain_N_per_V), facts.expires,
          record::ns_from_iso_time(facts.expires)};
}

RecordAnalysis::RecordAnalysis(daq::Calibration calibration, std::optional<daq::SecondChannel> speed,
                               const analysis::AnalysisSettings& settings, std::vector<daq::Gap> gaps)
    : calibration_(std::move(calibration)),
      speed_(std::move(speed)),
      analysis_(settings),
      gaps_(std::move(gaps)) {}

base::Result<RecordAnalysis> RecordAnalysis::make(const record::RecordHeader& header,
                                                  const std::filesystem::path& scratch_folder,
                                                  const estimate::SharedPrior& prior,
                                                  std::vector<daq::Gap> gaps,
                                                  const analysis::BootstrapSettings& bootstrap) {
  if (header.board.quantity == daq::RawQuantity::kCounts && !header.load_cell) {
    return base::usage_error("the record has counts but no load cell, so no forces");
  }
  const base::Result<model::Method> method = record::method_from_text(header.process.method);
  if (!method) return tl::unexpected(method.error());
  const base::Result<detect::EstimatorTier> estimator = record::estimator_of(header.process);
  if (!estimator) return tl::unexpected(estimator.error());
  const std::optional<analysis::SkippedCorrections> skipped =
      analysis::skipped_from_text(header.process.kept);
  if (!skipped) {
    return base::usage_error(
        "process/kept \"{}\" is not of \"spikes\", \"drift\" and \"first-slip\" with commas between",
        base::one_line(header.process.kept, 100));
  }
  estimate::SharedPrior recorded;
  if (prior.empty() && !header.process.characterisation.empty()) {
    const auto coupling =
        record::parse_tester(header.process.characterisation, "the record's characterisation");
    if (!coupling) return tl::unexpected(coupling.error());
    recorded.coupling = *coupling;
  }
  try {
    daq::Calibration calibration{header.board, header.load_cell.value_or(daq::LoadCell{}),
                                 header.tester.tester().normal_load_N()};
    analysis::AnalysisSettings settings = settings_of(header, calibration, *method, *estimator, *skipped);
    settings.scratch_folder = scratch_folder;
    settings.live = false;
    settings.bootstrap = bootstrap;
    settings.prior = prior.empty() ? recorded : prior;
    std::optional<daq::SecondChannel> speed;
    if (const auto& second = header.board.second;
        second && second->quantity == daq::SecondQuantity::kPullSpeed) {
      speed = *second;
      settings.speed_step_m_per_s = second->step();
    }
    RecordAnalysis analysis{std::move(calibration), std::move(speed), settings, std::move(gaps)};
    const daq::Calibration& used = analysis.calibration_;
    analysis.self_check_ = header.self_check;
    if (auto& check = analysis.self_check_; check && !check->raw.empty()) {
      std::optional<daq::RateEstimate> rate;
      if (check->scan_rate_Hz)
        rate = {*check->scan_rate_Hz, check->scan_rate_standard_error_Hz.value_or(0.0), {}};
      check =
          pipeline::check_idle(check->first_scan, header.self_check->raw, used, settings.scan_rate_Hz, rate);
    }
    analysis.facts_ = {.scan_rate_Hz = settings.scan_rate_Hz,
                       .start_realtime_ns = header.start_realtime_ns,
                       .calibration = calibration_in_use(header.load_cell, header.calibration),
                       .sled_mass_kg = header.tester.tester().sled_mass_kg,
                       .normal_load_N = used.normal_load_N(),
                       .was_cut_out = header.plan.start_coefficient.has_value(),
                       .level_before = header.plan.unloaded_level};
    return analysis;
  } catch (const std::invalid_argument& refused) {
    return base::usage_error("the record cannot be analysed: {}", refused.what());
  }
}

void RecordAnalysis::add(daq::ScanIndex first, std::span<const double> raw,
                         std::span<const std::int32_t> second) {
  if (raw.empty()) return;
  // A jump of the index is a gap, as for the processor; the gaps stored tell whether somebody counted.
  if (next_ && first != *next_) {
    const auto known = std::find_if(gaps_.begin(), gaps_.end(), [&](const daq::Gap& gap) {
      return gap.first == *next_ && gap.count == first - *next_;
    });
    analysis_.gap(*next_, first - *next_, known != gaps_.end() && known->estimated);
  }
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (speed_) analysis_.speed(speed_->value(second.empty() ? daq::SecondChannel::kNoCode : second[i]));
    const bool saturated = calibration_.saturated(raw[i]);
    ++facts_.scan_count;
    if (saturated) ++facts_.saturated_count;
    analysis_.add(first++, calibration_.coefficient(raw[i]), saturated);
  }
  next_ = first;
}

void RecordAnalysis::finish(record::EndRecord& end, std::span<const daq::ClockAnchor> anchors,
                            std::span<const daq::Gap> gaps) {
  end.results = analysis_.finish();
  facts_.anchors = anchors;
  facts_.gaps = gaps;
  facts_.self_check = self_check_ ? &*self_check_ : nullptr;
  facts_.level_after = end.unloaded_level;
  pipeline::add_facts(facts_, end.results);
  end.cycles = analysis_.take_cycles();
  end.spikes = analysis_.spikes();
}

namespace {

base::Result<TesterAnalysis> analyse_scans(const record::Record& record, const record::ScanSource& scans,
                                           const estimate::SharedPrior& prior,
                                           const std::filesystem::path& scratch_folder,
                                           const analysis::BootstrapSettings& bootstrap = {}) {
  base::Result<RecordAnalysis> analysis =
      RecordAnalysis::make(record.header, scratch_folder, prior, record.gaps, bootstrap);
  if (!analysis) return tl::unexpected(analysis.error());
  base::LongColumn<std::int32_t> codes{scans.has_second() ? scratch_folder : std::filesystem::path{}};
  if (scans.has_second()) {
    scans.for_each_second_piece([&codes](std::span<const std::int32_t> piece) {
      for (const std::int32_t code : piece) codes.push_back(code);
    });
  }
  std::size_t row = 0;
  scans.for_each_piece([&](const record::ScanPiece& piece) {
    for (std::size_t i = 0; i < piece.scan.size(); ++i, ++row) {
      std::int32_t code = daq::SecondChannel::kNoCode;
      if (!codes.empty()) code = std::as_const(codes)[row];
      analysis->add(piece.scan[i], piece.raw.subspan(i, 1), {&code, codes.empty() ? 0U : 1U});
    }
  });
  TesterAnalysis result;
  result.end = record.end.value_or(record::EndRecord{});
  analysis->finish(result.end, record.anchors, record.gaps);
  result.tester = analysis->tester();
  result.check = analysis->tester_check();
  result.bootstrap = analysis->bootstrap();
  return result;
}

}  // namespace

base::Result<TesterAnalysis> analyse_with_tester(const record::Record& record,
                                                 const estimate::SharedPrior& prior,
                                                 const std::filesystem::path& scratch_folder,
                                                 const analysis::BootstrapSettings& bootstrap) {
  return analyse_scans(record, record::RecordScans{record}, prior, scratch_folder, bootstrap);
}

base::Result<record::EndRecord> analyse(const record::Record& record,
                                        const std::filesystem::path& scratch_folder) {
  return analyse(record, record::RecordScans{record}, scratch_folder);
}

base::Result<record::EndRecord> analyse(const record::Record& record, const record::ScanSource& scans,
                                        const std::filesystem::path& scratch_folder) {
  base::Result<TesterAnalysis> result = analyse_scans(record, scans, {}, scratch_folder);
  if (!result) return tl::unexpected(result.error());
  return std::move(result->end);
}

}  // namespace stickslip::evaluation
