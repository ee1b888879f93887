/// \file
/// The shipped analysis over a record: the same walk as live, so the same bits.
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

/// What the header of a record says of its calibration, as the analysis needs it.
[[nodiscard]] pipeline::CalibrationInUse calibration_in_use(const std::optional<daq::LoadCell>& cell,
                                                            const record::CalibrationFacts& facts);

/// Scans come, results go; the record itself need not be in memory.
class RecordAnalysis {
 public:
  /// \param scratch_folder  where the scans of a long record may lie for the time being; empty: in memory.
  /// \param prior  what is known of the tester beforehand; empty: what the record says was known.
  /// \param gaps  what the record says of the jumps of its indices: which of them were counted by nobody.
  /// Errors: kUsage if the facts do not allow it (no scan rate, no load cell for counts).
  [[nodiscard]] static base::Result<RecordAnalysis> make(const record::RecordHeader& header,
                                                         const std::filesystem::path& scratch_folder = {},
                                                         const estimate::SharedPrior& prior = {},
                                                         std::vector<daq::Gap> gaps = {});

  // Both may throw std::system_error where there is a scratch folder.

  /// Consecutive scans from `first` on, after all before; a jump is a gap.
  /// \param second  codes of the second channel, as record::Record::second: as many, or none if there is no
  ///        such channel.
  void add(daq::ScanIndex first, std::span<const double> raw, std::span<const std::int32_t> second = {});

  /// Fills in results, cycles and spikes. Call once.
  /// \param anchors,gaps  of the record, for the scan rate.
  void finish(record::EndRecord& end, std::span<const daq::ClockAnchor> anchors = {},
              std::span<const daq::Gap> gaps = {});

  /// After finish(), as TestAnalysis.
  [[nodiscard]] const std::optional<analysis::TesterEstimate>& tester() const noexcept {
    return analysis_.tester();
  }
  [[nodiscard]] const std::optional<analysis::TesterCheck>& tester_check() const noexcept {
    return analysis_.tester_check();
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

/// Results, cycles and spikes of the record's scans; status, cause and truth stay those of the
/// record's end, if it has one. Errors as RecordAnalysis::make().
/// \param scratch_folder  as RecordAnalysis::make(), which tells what may be thrown.
[[nodiscard]] base::Result<record::EndRecord> analyse(const record::Record& record,
                                                      const std::filesystem::path& scratch_folder = {});
/// The same, with scans that are not in the record. Throws what reading the scans throws.
[[nodiscard]] base::Result<record::EndRecord> analyse(const record::Record& record,
                                                      const record::ScanSource& scans,
                                                      const std::filesystem::path& scratch_folder = {});

/// The same, with what the test says about the tester.
struct TesterAnalysis {
  record::EndRecord end;
  std::optional<analysis::TesterEstimate> tester;
  std::optional<analysis::TesterCheck> check;  ///< Only with a prior.
};
[[nodiscard]] base::Result<TesterAnalysis> analyse_with_tester(
    const record::Record& record, const estimate::SharedPrior& prior,
    const std::filesystem::path& scratch_folder = {});

}  // namespace stickslip::evaluation
