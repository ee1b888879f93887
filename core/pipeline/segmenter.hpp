/// \file
/// Where does a test begin and end in an endless stream of scans?
///
///     Segmenter segmenter{settings};
///     if (segmenter.observe(index, coefficient) == Segmenter::Event::kTestStarts) …
///
/// Only the force tells. A test begins when the force stays above a trigger. It ends when the force
/// stays near zero again (the carriage has returned), or when a full oscillation stops from one
/// period to the next and the force lies flat: then the belt has stopped with the coupling stretched.
/// An oscillation that dies away into a flat force is no end: the sled slides steadily, and
/// whether the belt still moves cannot be seen in the force.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/base/scan_index.hpp"
#include "core/friction/fall_finder.hpp"
#include "core/signal/despike.hpp"
#include "core/signal/noise.hpp"

namespace stickslip::pipeline {

/// Coefficients are force over normal load.
struct SegmenterSettings {
  double scan_rate_Hz = 350.0;
  double step_coefficient = 0.0;    ///< One A/D step; 0 if unknown.
  double start_coefficient = 0.05;  ///< Trigger.
  double start_dwell_s = 0.010;     ///< So long above the trigger.
  double end_coefficient = 0.02;    ///< Unloaded below it; < start_coefficient (hysteresis).
  double unload_dwell_s = 0.25;     ///< So long below it; longer than the slack part of a cycle.
  double no_motion_dwell_s = 0.5;   ///< So long flat, and at least four periods.
  double pre_trigger_s = 0.25;      ///< Kept from before the trigger.

  /// Scans from before the trigger that belong to the record.
  [[nodiscard]] std::size_t pre_trigger_scans() const noexcept;
};

/// Deterministic; what it decides during a test depends on the scans of the record only, so that
/// a replayed record ends where it ended. Thread-bound.
class Segmenter {
 public:
  enum class Event { kNone, kTestStarts, kUnloaded, kNoRelativeMotion };

  /// \throws std::invalid_argument unless rate and dwells are positive and
  ///         0 ≤ end_coefficient < start_coefficient.
  explicit Segmenter(const SegmenterSettings& settings);

  /// \param index rises; a jump forgets what was kept for the trigger.
  [[nodiscard]] Event observe(base::ScanIndex index, double coefficient);

  /// Waits for a test: the next scan may belong to its record. False while the force of the last
  /// test is still there.
  [[nodiscard]] bool armed() const noexcept { return state_ == State::kArmed; }

  /// A test has started and not ended.
  [[nodiscard]] bool running() const noexcept { return state_ == State::kRunning; }

 private:
  enum class State {
    kWaitingForUnload,  ///< A test is over but the force is not.
    kArmed,
    kRunning,
  };

  [[nodiscard]] std::int64_t scans(double seconds) const noexcept;
  void begin();
  /// Follows turning points and flatness of the running test.
  void follow(double coefficient);
  [[nodiscard]] bool belt_has_stopped() const;

  SegmenterSettings settings_;
  State state_ = State::kArmed;
  std::optional<base::ScanIndex> next_;
  std::deque<double> waiting_;  ///< As the record will begin with.
  std::int64_t above_ = 0;      ///< Consecutive scans at or above the trigger.
  std::int64_t below_ = 0;      ///< Consecutive scans below the end.

  // Of the running test.
  signal::NoiseEstimator noise_;
  signal::Despiker despiker_;
  friction::FallFinder falls_;
  double largest_drop_ = 0.0;
  double last_drop_ = 0.0;
  double last_period_ = 0.0;  ///< Scans.
  double last_peak_at_ = 0.0;
  int fall_count_ = 0;
  double smooth_ = 0.0;      ///< Force, averaged over the last few scans.
  double flat_level_ = 0.0;  ///< Where it was when the present flat stretch began.
  std::int64_t flat_scans_ = 0;
};

}  // namespace stickslip::pipeline
