/// \file
/// The motion of the sled without steps: closed-form pieces joined at events whose times are
/// solved for, so that the result does not depend on the scan rate.
///
///     Propagator sled{motion, 350.0};
///     std::array<double, 64> coefficient;
///     sled.next(coefficient);  // scans 0 … 63
///
/// Conventions of Penner 1995: slip starts when the spring alone holds S [13], unless the motion asks
/// for spring and damper; the load cell reads the spring.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/friction/oscillator.hpp"
#include "core/friction/slip_waveform.hpp"
#include "core/friction/truth.hpp"
#include "core/sim/paper.hpp"
#include "core/sim/scan_time.hpp"

namespace stickslip::sim {

/// The belt at constant speed for a while.
struct BeltSegment {
  double duration_s = 0.0;
  double speed_m_per_s = 0.0;  ///< Negative: the carriage returns.
  /// Stop the belt for the rest of the segment as soon as the force is zero.
  bool halt_when_unloaded = false;
};

/// What the motion stage of a scene comes to.
struct Motion {
  friction::Oscillator oscillator;
  double mu_s = 0.0;  ///< S ≥ mu_k
  double mu_k = 0.0;  ///< K ≥ 0
  double gravity_m_per_s2 = 0.0;
  bool damper_counts_at_onset = false;  ///< Slip starts when spring and damper together hold S.
  PaperSettings paper;                  ///< How S and K differ from contact to contact.
  bool one_way_coupling = false;
  std::vector<BeltSegment> belt;  ///< In order; at rest after the last.
};

/// The sled changes its mode.
struct ModeStart {
  ScanTime time;
  friction::Mode mode = friction::Mode::kStick;
  bool onset = false;        ///< A slip that starts because sticking gave way.
  bool capture = false;      ///< The slip before ended because the sled had reached the belt's speed.
  Coefficients paper;        ///< S and K in force.
  double coefficient = 0.0;  ///< Of the spring; below zero the slack.
};

/// Told of each change of mode, in order.
class MotionObserver {
 public:
  virtual ~MotionObserver() = default;
  virtual void mode_began(const ModeStart& start) = 0;
};

/// A stretch of time during which the force has one closed form.
struct ForceStretch {
  double duration_s = 0.0;
  /// Coefficient and its derivatives at the start.
  double c = 0.0;
  double rate_per_s = 0.0;
  double acceleration_per_s2 = 0.0;
  /// c‴ = −ω₀² c′ − γ c″; else c‴ = 0, and the force is zero, a line or a parabola.
  bool slips = false;
};

/// Shown the force between the instants, stretch by stretch without a hole.
class ForceFollower {
 public:
  virtual ~ForceFollower() = default;
  virtual void follow(const ForceStretch& stretch) = 0;
};

/// Needs the same memory however long it runs. Thread-bound.
class Propagator {
 public:
  /// \param scan_rate_Hz > 0. \param observer may be null; outlives the propagator.
  /// \param seed as in restart().
  Propagator(const Motion& motion, double scan_rate_Hz, MotionObserver* observer = nullptr,
             std::uint64_t seed = 1);

  /// Back to scan 0, at rest and unloaded, with these random numbers. Does not allocate.
  void restart(std::uint64_t seed);

  /// The coefficient F/(m g) at the next scans. Does not allocate.
  void next(std::span<double> coefficient);

  /// The coefficient at any instants in non-decreasing order; next() and skip() keep count of their
  /// own, and may go on only at scans that are not before the last instant. Does not allocate.
  [[nodiscard]] double at(const ScanTime& instant);

  /// As at(), but shows the whole force since the last call instead of its value. Does not allocate.
  void follow_to(const ScanTime& instant, ForceFollower& follower);

  /// Goes on by `scans` without looking at them, at the cost of the events alone.
  void skip(std::int64_t scans);

 private:
  /// What the sled is doing; two of them are slips, two are slack.
  enum class Phase { kStick, kSlower, kFaster, kFree, kRide };
  /// How the present piece will end.
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
  };

  [[nodiscard]] State state_at(double t_s) const;
  [[nodiscard]] double free_acceleration() const;
  [[nodiscard]] friction::SlipWaveform waveform() const;

  void next_segment();
  /// Chooses the phase from the state. \param capture as in ModeStart.
  void enter(State state, bool capture);
  void begin(Phase phase, State state, bool onset, bool capture);
  /// What the damper adds to the spring at the belt's speed, if it counts.
  [[nodiscard]] double damper_share() const;
  [[nodiscard]] double rested_s() const { return start_.periods_since(contact_start_) / scan_rate_Hz_; }
  [[nodiscard]] Phase phase_at_belt_speed(double c) const;
  void plan_end();
  void offer(Ending ending, std::optional<double> t_s);
  void plan_slip_end();
  void plan_free_end();
  [[nodiscard]] double slid_after(double t_s) const;
  void plan_new_place();
  void meet_new_place();
  void pass_end();
  void pass_until(const ScanTime& instant);
  [[nodiscard]] ForceStretch stretch_to(const ScanTime& instant) const;
  [[nodiscard]] double coefficient_at(const ScanTime& instant) const;

  Motion motion_;
  double scan_rate_Hz_;
  MotionObserver* observer_;
  double omega0_squared_;
  Paper paper_;
  double place_length_;      ///< Correlation length in units of the coefficient.
  double place_left_ = 0.0;  ///< Still to slide until a new place.

  std::int64_t next_scan_ = 0;
  ScanTime followed_to_;
  std::size_t segment_ = 0;  ///< Of motion_.belt; its size when all are over.
  ScanTime segment_end_;
  double belt_rate_ = 0.0;  ///< r = ω₀² v/g of the belt, 1/s
  bool halt_when_unloaded_ = false;

  Phase phase_ = Phase::kStick;
  ScanTime start_;  ///< Of the present piece.
  ScanTime contact_start_;
  State begun_{0.0, 0.0};        ///< State at start_.
  friction::SlipWaveform slip_;  ///< For the two slips; mirrored for kFaster.
  Ending ending_ = Ending::kNever;
  ScanTime end_;
  double duration_s_ = 0.0;  ///< From start_ to end_.
};

}  // namespace stickslip::sim
