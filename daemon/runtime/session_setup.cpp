#include "daemon/runtime/session_setup.hpp"

#include <system_error>
#include <utility>

#include "core/base/version.hpp"
#include "core/estimate/sampling.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/record/folder_probe.hpp"
#include "core/record/method_text.hpp"
#include "core/record/tester_file.hpp"

namespace stickslip::runtime {

base::Result<RecordFolder> prepare_record_folder(const std::filesystem::path& folder,
                                                 const record::FileCalls& calls) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return base::failure("record folder {}: cannot be made: {}", folder.string(), error.message());
  }
  // Permissions, read-only mounts, quotas, and what a file system lacks: only an attempt tells.
  const auto lacks = record::probe_folder(folder, calls);
  if (!lacks) return base::failure("record folder {}: {}", folder.string(), lacks.error().message);
  std::vector<std::string> told;
  for (const record::FolderLack& lack : *lacks)
    told.push_back(
        fmt::format("record folder {}: the file system {}: {}", folder.string(), lack.what, lack.follows));
  base::Result<storage::FolderLock> lock = storage::FolderLock::take(folder, calls);
  if (!lock) return tl::unexpected(lock.error());
  return RecordFolder{std::move(told), *std::move(lock)};
}

base::Result<SessionSettings> session_settings(const io::DaemonConfig& config,
                                               const drivers::OpenedBoard& opened,
                                               const SessionEnd& continues) {
  const daq::BoardInfo& board = opened.board->info();
  SessionSettings settings;
  settings.load_cell = config.bench.load_cell(opened.load_cell);
  // A board that runs faster than time may have no moment to wait, and RLIMIT_RTTIME would end it.
  if (config.clock_speed == 1.0) settings.realtime = config.realtime;
  settings.clock_speed = config.clock_speed;
  settings.processor.first_test_number = continues.next_test_number;
  if (const auto& from = continues.before.continuation) settings.processor.continues_at = from->end;
  settings.processor.recorded = opened.recorded;
  settings.processor.second = board.second;
  const io::BenchConfig& bench = config.bench;
  if (bench.calibration) {
    settings.calibration = *bench.calibration;
  } else if (!bench.load_cell_gain_N_per_V && !bench.load_cell_zero_V) {
    settings.calibration = opened.calibration;  // It belongs to the numbers that come with it.
  }
  settings.processor.calibration = evaluation::calibration_in_use(settings.load_cell, settings.calibration);
  settings.processor.automatic = config.begins_by_force;
  settings.processor.clock_is_real = config.clock_speed == 1.0;
  // A bench that runs faster than the wall must not lose what this machine cannot follow.
  settings.full_ring = settings.processor.clock_is_real ? FullRing::kDrop : FullRing::kWait;
  settings.processor.segmenter = config.segmenter;
  settings.processor.segmenter.scan_rate_Hz = board.scan_rate_granted_Hz;
  analysis::AnalysisSettings& analysis = settings.processor.analysis;
  analysis.scan_rate_Hz = board.scan_rate_granted_Hz;
  analysis.tester = config.bench.tester(opened.tester);
  analysis.method = config.method;
  settings.characterisation =
      config.bench.characterisation.empty() ? opened.characterisation : config.bench.characterisation;
  if (!settings.characterisation.empty()) {
    auto coupling = record::parse_tester(settings.characterisation, "characterisation");
    // The configuration's was checked with it; a record's may be damaged.
    if (!coupling) return tl::unexpected(coupling.error());
    analysis.prior.coupling = *std::move(coupling);
  }
  // As the next: a damaged word of a record is left out; `stickslip analyze` refuses it.
  analysis.estimator = config.estimator.value_or(
      detect::estimator_tier_from_name(opened.estimator).value_or(detect::EstimatorTier::kFit));
  analysis.skipped = analysis::either(
      config.skipped, analysis::skipped_from_text(opened.kept).value_or(analysis::SkippedCorrections{}));
  return settings;
}

record::RecordHeader record_header(const io::DaemonConfig& config, const SessionSettings& settings,
                                   const daq::BoardInfo& board, const std::string& realtime) {
  record::RecordHeader header;
  header.board = board;
  const daq::RawQuantity quantity = header.board.quantity;
  if (quantity == daq::RawQuantity::kCounts || quantity == daq::RawQuantity::kVolts) {
    header.load_cell = settings.load_cell;
  }
  if (header.load_cell) header.calibration = settings.calibration;
  header.sample = config.sample;
  const pipeline::SegmenterSettings& segmenter = settings.processor.segmenter;
  header.plan = {segmenter.start_coefficient, segmenter.start_dwell_s,  segmenter.pre_trigger_s,
                 segmenter.end_coefficient,   segmenter.unload_dwell_s, segmenter.no_motion_dwell_s};
  header.tester = record::TesterFacts::of(settings.processor.analysis.tester);
  header.process.program = "stickslipd";
  header.process.version = base::kVersion;
  header.process.commit = base::kCommit;
  header.process.configuration = config.text;
  header.process.estimator = detect::name(settings.processor.analysis.estimator);
  header.process.method = record::method_text(settings.processor.analysis.method);
  header.process.kept = analysis::text_of(settings.processor.analysis.skipped);
  header.process.characterisation = settings.characterisation;
  header.process.realtime = realtime;
  return header;
}

base::Result<estimate::SamplingVerdict> check_sampling(const io::DaemonConfig& config,
                                                       const SessionSettings& settings) {
  model::Tester plan = settings.processor.analysis.tester;
  if (config.bench.stiffness_N_per_m) plan.stiffness_N_per_m = config.bench.stiffness_N_per_m;
  estimate::SamplingVerdict verdict =
      estimate::check_sampling(settings.processor.analysis.scan_rate_Hz,
                               estimate::expected_frequency_Hz(plan, settings.processor.analysis.prior));
  // What was recorded is replayed as it is.
  const bool is_replay = config.board.driver == drivers::Driver::kReplay;
  if (verdict.kind == estimate::SamplingVerdict::Kind::kRefused && !is_replay)
    return base::usage_error("[board] scan_rate: {}", verdict.reason);
  return verdict;
}

}  // namespace stickslip::runtime
