/// \file
/// Exact motion of the sled without time steps: closed-form pieces joined at events whose times are solved
/// for. The result does not depend on the scan rate.
///
///     Propagator sled{motion, 350.0};
///     std::array<double, 64> coefficient;
///     sled.next(coefficient);  // scans 0 … 63
///
/// Conventions of Penner 1995: slip starts when the spring alone holds S [13], unless the motion asks
/// for spring and damper; the load cell reads the spring. The share a/g of the belt's acceleration a always
/// counts: the friction that moves the sled with the belt is q = c + a/g.
///
/// Each piece is an oscillation on a course: c(t) = h(t) + p(t). While the belt's speed and K are constant
/// ("plain") p is a line, a parabola or ±K, and everything about it is written out; else p is an
/// ExponentialPolynomial.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/model/slip_waveform.hpp"
#include "core/sim/exponential_polynomial.hpp"
#include "core/sim/first_rise.hpp"
#include "core/sim/motion.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// MotionSolver by closed forms. Its memory is constant. Thread-bound.
class Propagator final : public MotionSolver {
 public:
  /// \param motion  with has_closed_form(); is copied.
  /// \param scan_rate_Hz > 0.
  /// \param observer may be null; outlives the propagator.
  /// \param seed as in restart().
  Propagator(const Motion& motion, double scan_rate_Hz, MotionObserver* observer = nullptr,
             std::uint64_t seed = 1);

  void restart(std::uint64_t seed) override;
  void next(std::span<double> coefficient) override;
  [[nodiscard]] double at(const ScanTime& instant) override;
  void follow_to(const ScanTime& instant, ForceFollower& follower) override;
  void skip(std::int64_t scans) override;
  /// "exact closed forms", kExactAccuracy: event times too are exact to the last bits of a double.
  [[nodiscard]] SolverMethod method() const override { return {"exact closed forms", kExactAccuracy}; }

 private:
  /// Phase of the motion: kSlower and kFaster are slips, kFree and kRide are slack.
  enum class Phase { kStick, kSlower, kFaster, kFree, kRide };
  /// Event that ends the present piece.
  enum class Ending {
    kNever,
    kGivesWay,
    kCaptured,
    kUnloaded,
    kTouchesCoupling,
    kMeetsBelt,
    kNewPlace,
    kSegment
  };

  struct State {
    double c;     ///< Below zero with one-way coupling: the slack, as a coefficient.
    double rate;  ///< c′, 1/s
    bool operator==(const State&) const = default;
  };

  /// The oscillation of a slip.
  struct Wave {
    double h;
    double rate;  ///< h′, 1/s
  };

  /// The wave at a scan, to go on from there scan by scan.
  struct Stride {
    std::int64_t scan = -1;
    Wave wave{0.0, 0.0};
  };

  /// 2 × 2 matrix that advances a wave by one scan period.
  struct Turn {
    double h_from_h, h_from_rate, rate_from_h, rate_from_rate;
  };

  /// Initial conditions of a slip with constant belt speed and K: key of the cached event times, so that a
  /// periodic motion is solved once.
  struct PlainSlip {
    State begun{0.0, 0.0};
    double level = 0.0;  ///< ±K
    double belt_rate = 0.0;
    double push = 0.0;
    bool can_unload = false;
    bool operator==(const PlainSlip&) const = default;
  };
  struct SlipEnds {
    PlainSlip slip;
    std::optional<double> captured_s;
    std::optional<double> unloaded_s;
  };

  // propagator_belt.cpp: what belt and drift prescribe.
  void next_segment();
  /// Belt and drift as seen from start_.
  void look_ahead();
  void halt_belt();
  [[nodiscard]] ExponentialPolynomial drift_course(double piece_after_segment_s) const;
  [[nodiscard]] bool leaves_backwards() const;

  // propagator.cpp
  [[nodiscard]] bool slips() const { return phase_ == Phase::kSlower || phase_ == Phase::kFaster; }
  [[nodiscard]] bool rests_on_belt() const { return phase_ == Phase::kStick || phase_ == Phase::kRide; }
  [[nodiscard]] double seconds_since_start(const ScanTime& instant) const {
    return instant.periods_since(start_) / scan_rate_Hz_;
  }
  [[nodiscard]] Wave wave_at(double t_s) const;
  [[nodiscard]] State state_at(double t_s) const;
  /// Chooses the phase from the state. \param capture as in ModeStart.
  void enter(State state, bool capture);
  void begin(Phase phase, State state, bool onset, bool capture);
  /// The closed form of the piece that begins.
  void set_out();
  [[nodiscard]] double mu_k() const { return drift_factor_ * paper_.now().mu_k; }
  /// Static limit at start_.
  [[nodiscard]] double static_limit() const {
    return paper_.static_limit(rested_s()) + (mu_k() - paper_.now().mu_k);
  }
  /// q − c at the belt's speed: what its acceleration adds to the spring, and the damper if it counts.
  [[nodiscard]] double share_beside_spring() const;
  [[nodiscard]] double rested_s() const { return start_.periods_since(contact_start_) / scan_rate_Hz_; }
  [[nodiscard]] Phase phase_at_belt_speed(double c) const;
  void meet_new_place();
  void pass_end();
  void give_way(State state);
  void pass_until(const ScanTime& instant);
  [[nodiscard]] ForceStretch stretch_to(const ScanTime& instant) const;
  [[nodiscard]] double as_read(double c) const { return motion_.one_way_coupling && !(c > 0.0) ? 0.0 : c; }
  [[nodiscard]] double coefficient_at(const ScanTime& instant);
  void fill(std::span<double> coefficient);
  void stride_to(std::int64_t scan);

  // propagator_endings.cpp
  void plan_end();
  void offer(Ending ending, std::optional<double> t_s);
  void offer_giving_way(std::optional<double> t_s, double side);
  void plan_stick_end();
  void plan_slip_end();
  void plan_free_end();
  void plan_ride_end();
  [[nodiscard]] double slid_after(double t_s) const;
  void plan_new_place();
  /// Until the present segment is over.
  [[nodiscard]] double longest_s() const { return seconds_since_start(segment_end_); }
  // propagator_limits.cpp: when a limit that moves is reached.
  [[nodiscard]] std::optional<double> gives_way_s(const ExponentialPolynomial& held, double side,
                                                  double from_s) const;
  [[nodiscard]] std::optional<double> stick_gives_way_s(double side) const;

  Motion motion_;
  double scan_rate_Hz_;
  MotionObserver* observer_;
  double omega0_squared_;
  Turn turn_;
  Paper paper_;
  double place_length_;      ///< Correlation length in units of the coefficient.
  double place_left_ = 0.0;  ///< Still to slide until a new place.

  std::int64_t next_scan_ = 0;
  ScanTime followed_to_;
  std::size_t segment_ = 0;  ///< Of motion_.belt; its size when all are over.
  ScanTime segment_start_;
  ScanTime segment_end_;
  bool halt_when_unloaded_ = false;
  bool joins_smoothly_ = false;  ///< The segment began at the speed at which the one before had ended.
  bool plain_ = true;            ///< Belt speed and K are constant until the segment ends.
  double belt_rate_ = 0.0;       ///< r = ω₀² v/g of the belt at start_, 1/s
  double belt_slope_ = 0.0;      ///< r′ at start_, 1/s²
  double drift_factor_ = 1.0;    ///< f at start_
  // Unless plain:
  ExponentialPolynomial segment_rate_;  ///< r from segment_start_ on,
  double segment_travel_ = 0.0;         ///< ∫r before it.
  ExponentialPolynomial rate_;          ///< r, ∫r and f from start_ on.
  ExponentialPolynomial way_;
  ExponentialPolynomial factor_;

  Phase phase_ = Phase::kStick;
  ScanTime start_;  ///< Of the present piece.
  ScanTime contact_start_;
  State begun_{0.0, 0.0};  ///< State at start_.
  double push_ = 0.0;      ///< Sign of the friction: +1 while the sled is slower than the belt.
  /// Oscillation of a slip; about ±K if plain, else K = 0.
  model::SlipWaveform slip_;
  ExponentialPolynomial course_;  ///< Unless plain: c − h from start_ on.
  ExponentialPolynomial course_rate_;
  Stride stride_;
  SlipEnds last_slip_;  ///< Of the last slip that was solved.
  Ending ending_ = Ending::kNever;
  double gives_way_to_ = 0.0;  ///< +1: towards the slower side.
  ScanTime end_;
  double duration_s_ = 0.0;  ///< From start_ to end_.
};

}  // namespace stickslip::sim
