/// \file
/// Follows a slip from its fall on: decides how it ends, and estimates S and K.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "core/detect/belt_change.hpp"
#include "core/detect/capture_test.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/detect/rise.hpp"
#include "core/estimate/cycle_fit.hpp"

namespace stickslip::detect {

/// Follows one slip at a time. step() does at most one task for each scan: a test or a fit of up to 256
/// points, or two of them if the belt's speed may have changed. force() does those that remain. Fixed memory;
/// never allocates.
class SlipFollower {
 public:
  /// \param scan_rate_Hz > 0.
  SlipFollower(EstimatorTier tier, double scan_rate_Hz, estimate::SharedPrior prior)
      : tier_(tier), scan_s_(1.0 / scan_rate_Hz), knowledge_(std::move(prior)) {}

  /// The next scan that is usable: it is no spike and not saturated.
  void add(double time_s, double value) noexcept { buffer_.add(time_s, value); }
  /// Reports a fall under way: times of its peak and of its lowest point so far. Its scans are then merged
  /// into short blocks only (CycleBuffer::keep_fine()).
  void falls(double peak_s, double lowest_s) noexcept;
  /// Scans are missing after the last one; later scans are not connected with earlier ones. A slip whose end
  /// is not decided yet stays undecided.
  /// \param now_s  time of the last scan before the gap.
  void gap(double now_s) noexcept;

  /// Begins a confirmed slip and ends the one before; call force() and read slip() first.
  /// \param peak_s,trough_s  times of the fall's turning points.
  /// \param begins_from_stick  false only in a ring-down, whose oscillation goes on. A slip too large for a
  ///        free oscillation is taken to begin from sticking in any case.
  /// \param sigma  noise of one scan.
  void open(const Fall& fall, double peak_s, double trough_s, bool begins_from_stick, double sigma) noexcept;
  /// Does the task that is due, if there is one. From 2.5 periods after the peak on it decides as force()
  /// does with has_next; what that leaves undecided stays so. \return true if it decided how the slip ends.
  [[nodiscard]] bool step(double now_s, double sigma) noexcept {
    return state_ > State::kDone && !(now_s < now_.next_task_s) && do_task(now_s, sigma);
  }
  /// Does the remaining tasks with the available scans, but no fit of ω, γ and r before the first test.
  /// \param has_next  a slip follows: then the end is decided without kDecisive, as captured if that is
  ///        likelier, as free at kDecisiveLikelihoodRatio.
  /// \return true if this decided how the slip ends.
  [[nodiscard]] bool force(double now_s, double sigma, bool has_next) noexcept;
  void close() noexcept { on(Event::kClosed); }

  [[nodiscard]] bool is_open() const noexcept { return state_ != State::kClosed; }
  [[nodiscard]] bool decided() const noexcept { return now_.decided; }
  /// False also if it is not decided.
  [[nodiscard]] bool captured() const noexcept { return (slip_.cycle.flags & kCycleCaptured) != 0; }
  /// The slip begun last; of its flags only kCycleCaptured is set. The caller sets the other flags, number,
  /// first_scan and period_s.
  [[nodiscard]] const LiveCycle& slip() const noexcept { return slip_; }
  /// Mutable, so that the caller can set values that it knows better.
  [[nodiscard]] LiveCycle& slip() noexcept { return slip_; }
  /// Estimates of ω, γ and r in use for the slip begun last. A fit of its scans up to the trough changes them
  /// at once, and so does a belt speed that changed. The fit after the decision counts from the next open()
  /// on. Not before the first open().
  [[nodiscard]] const model::SharedParameters& shared() const noexcept { return now_.shared; }

 private:
  /// Capture tests in a period.
  static constexpr double kTestsPerPeriod = 32.0;

  /// step() has work only in the states after kDone.
  enum class State { kClosed, kDone, kFirstFit, kTesting, kFitting };
  enum class Event {
    kOpened,         ///< A slip has begun.
    kOpenedUnknown,  ///< From sticking, and only its own scans tell ω, γ and r: they are fitted first.
    kFirstFitted,
    kTold,        ///< How it ended is decided, or will not be; it began from sticking.
    kToldOfFree,  ///< As kTold, for a slip that began from a free oscillation. It gets no fit.
    kScansEnd,    ///< No further scan belongs to it: a gap, the next slip or the end of the test.
    kEstimated,
    kClosed,
  };
  struct Transition {
    State state;
    Event event;
    State next;
  };
  static constexpr std::array<Transition, 9> kTransitions{{
      {State::kClosed, Event::kOpened, State::kTesting},
      {State::kClosed, Event::kOpenedUnknown, State::kFirstFit},
      {State::kFirstFit, Event::kFirstFitted, State::kTesting},
      {State::kFirstFit, Event::kScansEnd, State::kDone},
      {State::kTesting, Event::kTold, State::kFitting},
      {State::kTesting, Event::kToldOfFree, State::kDone},
      {State::kTesting, Event::kScansEnd, State::kDone},
      {State::kFitting, Event::kEstimated, State::kDone},
      {State::kFitting, Event::kScansEnd, State::kDone},
  }};
  /// kClosed leads from any state to kClosed. An event that the table does not hold changes nothing.
  void on(Event event) noexcept;

  /// The slip under way.
  struct UnderWay {
    bool decided = false;
    bool begins_from_stick = false;
    bool whole = false;      ///< No scan is missing since its peak.
    bool estimated = false;  ///< Its S and K, as far as its scans tell them.
    double next_task_s = -std::numeric_limits<double>::infinity();
    Fall fall;
    double peak_s = 0.0;
    double trough_s = 0.0;
    double rise_slope = 0.0;  ///< 0: not worked out; NaN: its scans are gone.
    /// Scans from here on tell how it ends; NaN until tested.
    double test_from_s = std::numeric_limits<double>::quiet_NaN();
    model::SharedParameters shared;
    std::optional<model::SlipParameters> first_fit;  ///< To the trough, where it was fitted and converged.
    CaptureEvidence evidence;
  };

  /// What the slips before have in common.
  struct Usual {
    double delta_mu = 0.0;
    double count = 0.0;       ///< Slips behind it.
    double wait_s = 0.0;      ///< From a peak until captures were decided; 0 if none was.
    double wait_count = 0.0;  ///< Slips behind it.
  };

  /// Before the peak.
  [[nodiscard]] Rise rise() const noexcept;
  /// Its slope, worked out once for a slip and only if it is asked for. NaN behind a gap.
  [[nodiscard]] double rise_slope(double sigma) noexcept;
  [[nodiscard]] bool do_task(double now_s, double sigma) noexcept;
  void first_fit(double sigma) noexcept;
  void schedule_first_test() noexcept;
  [[nodiscard]] bool judge(double now_s, double sigma, bool last) noexcept;
  /// The next drop if it goes on freely.
  [[nodiscard]] double freely_next_drop() const noexcept;
  /// \param residual_sigmas  what this slip's scans leave with the slope of the rise before it as stick rate.
  /// \param before_sigmas  with the one known.
  [[nodiscard]] bool belt_changed(double residual_sigmas, double before_sigmas) noexcept;
  /// Sets now_.evidence. If only another belt speed explains the scans, takes the slope of the rise as stick
  /// rate and discards the first fit. \param decisive  as Budget::decisive.
  void test_capture(double sigma, double decisive) noexcept;
  void decide(double evidence, double now_s) noexcept;
  void schedule_next_test(double now_s) noexcept { now_.next_task_s = now_s + period_s() / kTestsPerPeriod; }
  void estimate(double now_s, double sigma) noexcept;
  void estimate_by_turning_points(double sigma) noexcept;
  /// \param fall_s  from peak to trough.
  void learn_turning_points(double fall_s, double sigma) noexcept;
  void estimate_by_fit(double window_end_s, double sigma) noexcept;
  /// Fills slip_ with S, K, S − K, slip speed ratio and times, and keeps the time of the capture.
  /// \param capture_s  time of the capture, as those of Cycle; ignored if the slip was not captured.
  void take_course(const model::SlipParameters& slip, double slip_speed_ratio, double capture_s) noexcept;
  void learn_typical(double delta_mu) noexcept;
  [[nodiscard]] model::SlipParameters first_guess() const noexcept;
  /// How long before the peak it surely slips: the onset is a guess.
  [[nodiscard]] double slipping_before_peak_s() const noexcept;
  [[nodiscard]] double period_s() const noexcept;

  EstimatorTier tier_;
  double scan_s_;
  estimate::SharedPosterior knowledge_;
  bool started_whole_ = false;  ///< knowledge_, by a fall without a gap.
  estimate::CycleBuffer buffer_;
  CaptureTest capture_test_;
  BeltChange belt_change_;

  State state_ = State::kClosed;
  UnderWay now_;
  LiveCycle slip_;
  Usual usual_;
  std::int64_t slip_number_ = 0;
  /// Where the last gap begins: a scan is missing.
  double gap_s_ = -std::numeric_limits<double>::infinity();
  double window_from_s_ = 0.0;  ///< Scans before belong to the slip before.
  double last_capture_s_ = std::numeric_limits<double>::quiet_NaN();  ///< NaN if unknown.
};

}  // namespace stickslip::detect
