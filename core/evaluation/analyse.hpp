/// \file
/// Analysis of a record's scans. It is that of the live test, so that results are the same to the last bit,
/// unless the record lacks scans that the live analysis saw (daq::GapCause::kStorageFull, kDamaged).
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "core/analysis/test_analysis.hpp"
#include "core/base/result.hpp"
#include "core/daq/calibration.hpp"
#include "core/pipeline/test_facts.hpp"
#include "core/record/record.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::evaluation {

/// What the header of a record says of its calibration, as the analysis needs it; empty without a load cell.
[[nodiscard]] pipeline::CalibrationInUse calibration_in_use(const std::optional<daq::LoadCell>& cell,
                                                            const record::CalibrationFacts& facts);

/// Analyses the scans of a record piece by piece; the record need not be in memory. Thread-bound.
class RecordAnalysis {
 public:
  /// \param scratch_folder  where the scans of a long record may lie for the time being; empty: in memory.
  /// \param prior  of the tester's parameters; empty: the characterisation in the record, if it has one.
  /// \param gaps  of the record: whether the length of each was counted or estimated. A gap that is not
  /// among them is taken as counted.
  /// Errors: kUsage if the header does not allow it, such as by no scan rate, counts without a load cell, or
  /// a method, estimator, `kept` or characterisation that cannot be read.
  [[nodiscard]] static base::Result<RecordAnalysis> make(const record::RecordHeader& header,
                                                         const std::filesystem::path& scratch_folder = {},
                                                         const estimate::SharedPrior& prior = {},
                                                         std::vector<daq::Gap> gaps = {},
                                                         const analysis::BootstrapSettings& bootstrap = {});

  // Both may throw std::system_error where there is a scratch folder.

  /// Consecutive scans from `first` on, after all before; a jump is a gap.
  /// \param raw  of the quantity header.board.quantity; finite; may be empty.
  /// \param second  codes of the second channel, as record::Record::second: as many, or none if there is no
  ///        such channel.
  void add(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second = {});

  /// Fills in results, cycles and spikes; reads `unloaded_level`. Call once.
  /// \param anchors,gaps  of the record, for the scan rate.
  void finish(record::EndRecord& end, std::span<const daq::ClockAnchor> anchors = {},
              std::span<const daq::Gap> gaps = {});

  // After finish(), as TestAnalysis.
  [[nodiscard]] const std::optional<analysis::TesterEstimate>& tester() const noexcept {
    return analysis_.tester();
  }
  [[nodiscard]] const std::optional<analysis::TesterCheck>& tester_check() const noexcept {
    return analysis_.tester_check();
  }
  [[nodiscard]] const std::optional<analysis::Bootstrap>& bootstrap() const noexcept {
    return analysis_.bootstrap();
  }

 private:
  RecordAnalysis(daq::Calibration calibration, std::optional<daq::SecondChannel> speed,
                 const analysis::AnalysisSettings& settings, std::vector<daq::Gap> gaps);

  daq::Calibration calibration_;
  std::optional<daq::SecondChannel> speed_;  ///< If the second channel measures it.
  pipeline::TestFacts facts_;
  std::optional<daq::SelfCheck> self_check_;  ///< Computed again from its scans.
  analysis::TestAnalysis analysis_;
  std::vector<daq::Gap> gaps_;
  std::optional<daq::ScanIndex> next_;
};

/// Results, cycles and spikes of the record's scans. All else is that of the record's end; without one, the
/// default, also the status: complete. Errors as RecordAnalysis::make().
/// \param scratch_folder  as RecordAnalysis::make(); with one std::system_error may be thrown.
[[nodiscard]] base::Result<record::EndRecord> analyse(const record::Record& record,
                                                      const std::filesystem::path& scratch_folder = {});
/// As analyse(record), with scans that are not in the record. Throws what reading the scans throws.
[[nodiscard]] base::Result<record::EndRecord> analyse(const record::Record& record,
                                                      const record::ScanSource& scans,
                                                      const std::filesystem::path& scratch_folder = {});

/// Results of a record, with what the test says about the tester.
struct TesterAnalysis {
  record::EndRecord end;                           ///< As analyse().
  std::optional<analysis::TesterEstimate> tester;  ///< TestAnalysis::tester()
  std::optional<analysis::TesterCheck> check;      ///< TestAnalysis::tester_check()
  std::optional<analysis::Bootstrap> bootstrap;    ///< TestAnalysis::bootstrap()
};
/// \param prior  as RecordAnalysis::make(). Errors and exceptions as analyse().
[[nodiscard]] base::Result<TesterAnalysis> analyse_with_tester(
    const record::Record& record, const estimate::SharedPrior& prior,
    const std::filesystem::path& scratch_folder = {}, const analysis::BootstrapSettings& bootstrap = {});

}  // namespace stickslip::evaluation
