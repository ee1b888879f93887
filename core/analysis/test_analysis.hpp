/// \file
/// Analysis of one test, scan by scan, from the first pre-trigger scan to the end. Slips are reported live;
/// finish() returns all results. Live, replay and batch run this same class over the same scans, so their
/// results have the same bits.
///
///     TestAnalysis analysis{settings};
///     for (…) analysis.add(index, coefficient, saturated);
///     const TestResults results = analysis.finish();
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/analysis/analysis_settings.hpp"
#include "core/analysis/bootstrap.hpp"
#include "core/analysis/characterisation.hpp"
#include "core/analysis/results.hpp"
#include "core/analysis/sections.hpp"
#include "core/analysis/signal_check.hpp"
#include "core/analysis/slack.hpp"
#include "core/base/long_column.hpp"
#include "core/base/scan_index.hpp"
#include "core/detect/cycle.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/detect/live_detector.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// The analysis of one test. Thread-bound. Memory grows with the test by about 34 bytes a scan, 8 more with
/// speed(), and 0.4 kB a slip; finish() needs more for a while where it takes a transducer off. With a
/// scratch folder memory grows by 16 bytes a spike, 24 bytes a gap and 8 bytes for 64 scans (and by the slips
/// where the pull speed changes), and functions may throw std::system_error.
class TestAnalysis {
 public:
  /// \throws std::invalid_argument unless the rate is positive and finite.
  explicit TestAnalysis(const AnalysisSettings& settings);

  /// The pull speed at the next scan, m/s; NaN if unknown, which counts as the speed before it, or 0 at the
  /// first scan. Call before each add() if settings.speed_step_m_per_s is set, else never.
  void speed(double speed_m_per_s);
  /// The next scan.
  /// \param index        rises; before a jump call gap(). \param coefficient  calibrated; must be finite.
  /// \param saturated    the converter was at a rail.
  void add(base::ScanIndex index, double coefficient, bool saturated);
  /// Scans [first, first + count) are missing. Call between the add() before them and the one after.
  /// \param estimated  the count comes from a clock; the gap is then a break, however short.
  void gap(base::ScanIndex first, std::int64_t count, bool estimated = false);

  // The next three functions require settings.live.

  /// Cycles completed since the last call, as the detector sees them live; finish() refines them. A cycle is
  /// complete when the next slip is seen, or the oscillation has died away.
  [[nodiscard]] std::vector<detect::Cycle> take_new_cycles();
  /// Falls of the force detected since the last call; none before the loading. A fall is detected
  /// LiveDetector::kFallDelayScans after the force has fallen by the hysteresis, or 1 if skipped.spikes;
  /// whether it is a slip is not known yet.
  [[nodiscard]] std::vector<detect::FallBegun> take_new_falls();
  /// Ends the live detection and completes the cycle under way; finish() does this too.
  void end_live();
  /// Present phase and regime; idle and undecided unless settings.live.
  [[nodiscard]] const detect::LiveState& live() const noexcept { return live_.state(); }

  /// Returns the results of the whole test. Call once. With fewer scans than signal::kFewestScansForNoise
  /// only spikes, gaps and lost scans are counted. scan_rate_measured and the uncertainties by calibration
  /// and zero are absent: core/pipeline adds them.
  [[nodiscard]] TestResults finish();

  /// After finish(): one cycle for each slip; empty if there is none. Cycle::delta_mu is also NaN for slips
  /// that ended in slack, and for all if the results have no S − K.
  [[nodiscard]] const base::LongColumn<detect::Cycle>& cycles() const noexcept { return cycles_; }
  /// Moves the cycles out.
  [[nodiscard]] base::LongColumn<detect::Cycle> take_cycles() { return std::exchange(cycles_, {}); }
  /// After finish(): the tester's parameters from this test alone, without settings.prior; nullopt unless
  /// such a fit describes the test, or if SignalCheck::voids() its results.
  [[nodiscard]] const std::optional<TesterEstimate>& tester() const noexcept { return tester_; }
  /// After finish(): check against settings.prior.coupling; nullopt without it, without tester(), or if the
  /// fit with that prior did not converge.
  [[nodiscard]] const std::optional<TesterCheck>& tester_check() const noexcept { return tester_check_; }
  /// After finish(): how the results scatter if the slips are drawn again, or why that is not told; nullopt
  /// unless settings.bootstrap.count > 0.
  [[nodiscard]] const std::optional<Bootstrap>& bootstrap() const noexcept { return bootstrap_; }
  /// After finish(): scans that were found to be spikes.
  [[nodiscard]] const std::vector<base::ScanIndex>& spikes() const noexcept { return spikes_; }
  /// After finish(): the measured coefficient of each spike.
  [[nodiscard]] const std::vector<double>& spike_coefficients() const noexcept { return spike_coefficients_; }

 private:
  struct Gap {
    base::ScanIndex first;
    std::int64_t count;
    bool estimated;
  };

  /// What another thread needs of the scans: views of the columns.
  struct Scans {
    base::LongColumn<base::ScanIndex> indices;
    base::LongColumn<double> coefficients;
    base::LongColumn<std::uint8_t> saturated;
    std::vector<Gap> gaps;
    std::filesystem::path scratch_folder;
  };

  void keep_live(const detect::LiveCycle& cycle);
  /// Reads the speed channel and its resolution; fills measured_speed_.
  void read_speeds(const estimate::Trace& trace);
  /// The speed of the pull, as measured or else as planned, into the trace; forgets falls that are no slips.
  void follow_speed(estimate::Trace& trace, base::LongColumn<detect::Fall>& slips) const;
  /// Where nothing tells that the speed changes: the holds that the force shows, into the trace and the
  /// findings. \param sigma  noise of a scan.
  void follow_holds(estimate::Trace& trace, base::LongColumn<detect::Fall>& slips, double sigma,
                    TestResults& results) const;
  /// All scans with the noise of the whole test known; fills spikes_ and spike_coefficients_.
  [[nodiscard]] estimate::Trace despiked_trace();
  /// Scans that are clipped or frozen are no measurement: as those at a rail of the converter.
  void leave_out(const SignalCheck& check, estimate::Trace& trace);
  /// Breaks the trace at the gaps that may hide a slip, and forgets the slips that reach into one.
  void break_at_gaps(estimate::Trace& trace, base::LongColumn<detect::Fall>& slips) const;
  /// When the slip began after which the sled behaved otherwise.
  [[nodiscard]] static Estimate transition_time(const estimate::Trace& trace, const TestEstimates& estimates,
                                                const base::LongColumn<detect::Fall>& slips,
                                                std::size_t slip);
  /// Into cycles_, with their flags. \param tells_delta_mu  whether the S − K of a slip holds.
  void keep_cycles(const estimate::Trace& trace, const TestEstimates& estimates,
                   const base::LongColumn<detect::Fall>& slips,
                   const std::function<bool(const detect::Fall&)>& tells_delta_mu);
  /// If a bootstrap is asked for: why there is none.
  void no_bootstrap(std::string reason);
  /// Fills pull_speed_measured, from the stick rate and ω₀, or tells why it has no value; adds the findings
  /// of tester_check_, or kPullSpeed without it. If the sled may never have stuck, S and S − K become absent,
  /// too. \param results  with K already.
  void speed_results(const estimate::Trace& trace, const TestEstimates& estimates,
                     TestResults& results) const;
  /// Estimates from cycles with turning points. \param reason  why no results of a fit are there.
  [[nodiscard]] TestEstimates by_turning_points(const estimate::Trace& trace,
                                                const base::LongColumn<detect::Fall>& slips,
                                                const base::LongColumn<detect::LiveCycle>& cycles,
                                                std::string reason, const Slack& slack = {}) const;
  /// The cycles of scans as add() sees them. May run in another thread than the one that calls this class.
  [[nodiscard]] static base::LongColumn<detect::LiveCycle> detected(const detect::LiveSettings& settings,
                                                                    const Scans& scans);
  [[nodiscard]] bool fits_whole_test() const noexcept {
    return settings_.estimator == detect::EstimatorTier::kFit;
  }

  AnalysisSettings settings_;
  base::LongColumn<base::ScanIndex> indices_;
  base::LongColumn<double> coefficients_;
  base::LongColumn<std::uint8_t> saturated_;
  base::LongColumn<double> speeds_m_per_s_;         ///< Empty unless measured.
  std::optional<model::PullSpeed> measured_speed_;  ///< From the first scan on; in finish().
  double speed_resolution_m_per_s_ = 0.0;
  std::vector<Gap> gaps_;

  detect::LiveDetector live_;
  std::vector<detect::Cycle> new_cycles_;  ///< With room for those of a second at 100 a second.
  std::vector<detect::FallBegun> new_falls_;
  base::LongColumn<detect::LiveCycle> live_cycles_;  ///< As the live side saw them.

  base::LongColumn<detect::Cycle> cycles_;
  std::optional<TesterEstimate> tester_;
  std::optional<TesterCheck> tester_check_;
  std::optional<Bootstrap> bootstrap_;
  std::vector<base::ScanIndex> spikes_;
  std::vector<double> spike_coefficients_;
};

}  // namespace stickslip::analysis
