/// \file
/// Plain motions in 50 digits: the reference of `stickslip accuracy` and of the numeric tests.
///
///     Reference sled{motion, 350.0};
///     std::array<double, 64> coefficient;
///     sled.next(coefficient);  // scans 0 … 63, each correctly rounded or the neighbour of that
///
/// It shares no code with sim::Propagator: closed forms in the paper's own shape, Coulomb's friction,
/// time as one number of 50 digits, of which 10⁷ s at 350 scans a second leave 40.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/accuracy/oscillation50.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::accuracy {

/// Feature of the motion that excludes a reference in 50 digits; empty if there is none. Supported: belt
/// segments of constant speed, any damping, both couplings, both onset conventions, uniform paper.
[[nodiscard]] std::string_view lacks_reference(const sim::Motion& motion) noexcept;

/// Computes the scans of a plain motion one after the other, in 50 digits and constant memory. Thread-bound.
class Reference {
 public:
  /// \param motion  lacks_reference() is empty. \param scan_rate_Hz > 0.
  Reference(const sim::Motion& motion, double scan_rate_Hz);

  /// Computes the coefficient at the next scans, rounded to double.
  void next(std::span<double> coefficient);
  /// Skips `scans` scans, ≥ 0; takes time only for the events between.
  void skip(std::int64_t scans);
  /// The coefficient at the next scan, with all digits. next() still begins with that scan, but the functions
  /// below tell the events up to it.
  [[nodiscard]] Real now();

  /// Slips so far that ended because the sled reached the belt's speed.
  [[nodiscard]] std::int64_t capture_count() const noexcept { return capture_count_; }
  /// Start of the present piece of motion, s after scan 0: a stick, a slip, a flight, or a ride with the belt
  /// in a slack coupling. Each belt segment begins a piece, and so does a halt within one.
  [[nodiscard]] const Real& piece_start_s() const noexcept { return start_s_; }
  /// The latest onset of a slip from sticking, s after scan 0; nullopt if there was none.
  [[nodiscard]] const std::optional<Real>& last_onset_s() const noexcept { return last_onset_s_; }
  /// The latest capture, s after scan 0; nullopt if there was none.
  [[nodiscard]] const std::optional<Real>& last_capture_s() const noexcept { return last_capture_s_; }

 private:
  enum class Phase { kStick, kSlower, kFaster, kFlies, kRides };
  enum class Event { kNone, kOnset, kCapture, kUnloads, kLoads, kMeetsBelt };
  struct State {
    Real c, rate;
  };
  struct Solved {
    Real c, rate, belt_rate;
    std::optional<Real> capture_s;
  };

  [[nodiscard]] State state_at(const Real& t_s) const;
  void go_to(const Real& instant_s);
  void happens();
  void settle(const State& state);
  void begin(Phase phase, const State& state);
  void plan();
  void plan_slip();
  void plan_flight();
  void offer(Event event, const std::optional<Real>& t_s);
  void next_segment();
  [[nodiscard]] Real damper_share() const;
  [[nodiscard]] Real friction() const;

  sim::Motion motion_;
  Real scan_period_s_, gamma_, omega_squared_, omega0_squared_, S_, K_;
  std::int64_t next_scan_ = 0;

  std::size_t segment_ = 0;
  std::optional<Real> segment_end_s_;
  Real belt_rate_ = 0;
  bool halts_ = false;

  Phase phase_ = Phase::kStick;
  Real start_s_ = 0;
  State begun_{0, 0};
  Oscillation50 slip_;
  Event event_ = Event::kNone;
  Real event_s_ = 0;  ///< After start_s_.
  /// Of the latest slip from sticking: in a steady cycle all start from the same state.
  std::optional<Solved> solved_;

  std::int64_t capture_count_ = 0;
  std::optional<Real> last_onset_s_;
  std::optional<Real> last_capture_s_;
};

}  // namespace stickslip::accuracy
