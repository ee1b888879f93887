/// \file
/// Where does a test begin and end in an endless stream of scans?
///
///     Segmenter segmenter{settings};
///     if (segmenter.observe(index, coefficient) == Segmenter::Event::kTestStarts) …
///
/// The force tells, or somebody who commands. By the force a test begins when it stays above a trigger. It
/// ends when it stays near zero again (the carriage has returned), or when a full oscillation stops from one
/// period to the next and the force lies flat: then the belt has stopped with the coupling stretched.
/// Trigger and end are above the level of the unloaded cell, which is followed on quiet scans
/// (unloaded_level.hpp): before a test each quiet force up to UnloadedLevel::kFarthest is that level; during
/// and after a test only one that lies below a third of the largest force. Until a level is known it is taken
/// for the calibrated zero; but a force that has not been below the trigger begins a test only from kFarthest
/// on.
///
/// An oscillation that dies away into a flat force is no end: the sled slides steadily, and
/// whether the belt still moves cannot be seen in the force.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "core/base/scan_index.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/pipeline/unloaded_level.hpp"
#include "core/signal/despike.hpp"
#include "core/signal/noise.hpp"

namespace stickslip::pipeline {

/// Coefficients are force over normal load.
struct SegmenterSettings {
  double scan_rate_Hz = 350.0;
  double step_coefficient = 0.0;    ///< One A/D step; 0 if unknown.
  double start_coefficient = 0.05;  ///< Trigger, above the unloaded level.
  double start_dwell_s = 0.010;     ///< So long above the trigger.
  double end_coefficient = 0.02;    ///< Unloaded below it; < start_coefficient (hysteresis).
  double unload_dwell_s = 0.25;     ///< So long below it; longer than the slack part of a cycle.
  double no_motion_dwell_s = 0.5;   ///< So long flat, and at least four periods.
  double pre_trigger_s = 0.25;      ///< Kept from before the trigger.

  /// Of the first scan, where it is known from a record: it stands until the first test has begun.
  std::optional<double> unloaded_level = {};

  /// Scans from before the trigger that belong to the record.
  [[nodiscard]] std::size_t pre_trigger_scans() const noexcept;
};

/// Deterministic; what it decides during a test depends on the scans of the record only, so that
/// a replayed record ends where it ended. Thread-bound.
class Segmenter {
 public:
  enum class Event {
    kNone,
    kTestStarts,
    kUnloaded,
    kNoRelativeMotion,
    kPulledAgain,  ///< Before the force of a test was seen to be gone; no test begins by it. Once a test.
  };

  /// \throws std::invalid_argument unless rate and dwells are positive and
  ///         0 ≤ end_coefficient < start_coefficient.
  explicit Segmenter(const SegmenterSettings& settings);

  /// Whether a force above the trigger begins a test; at first it does. Changes nothing for a running test.
  void trigger_by_force(bool on) noexcept { by_force_ = on; }
  /// From here on a force above the trigger begins a test. \return true if it was there within the
  /// pre-trigger time already: then what was kept is forgotten, because a replay, which cannot see when this
  /// was called, would have begun the test there.
  [[nodiscard]] bool arm();
  /// The next scan begins a test, whatever its force; only while ready(). Until the force has once stayed
  /// above the trigger, no unloading ends that test.
  void start() noexcept;
  /// The scan observed last was the last of the running test; or the start that was asked for is not to be.
  void stop() noexcept;

  /// \param index rises; a jump forgets what was kept for the trigger.
  [[nodiscard]] Event observe(base::ScanIndex index, double coefficient);

  /// The next scan may belong to the record of a test to come. False during a test, and while the force of
  /// the last one is still there.
  [[nodiscard]] bool ready() const noexcept { return state_ == State::kReady; }

  /// A test has started and not ended.
  [[nodiscard]] bool running() const noexcept { return state_ == State::kRunning; }

  /// What the unloaded cell reads, as quiet scans told; nothing before they did.
  [[nodiscard]] std::optional<double> unloaded_level() const noexcept { return level_; }
  /// What the cell read at the end of the latest test; only after kUnloaded, and if the force was quiet.
  [[nodiscard]] std::optional<double> level_after() const noexcept { return level_after_; }
  /// A force from here on begins a test, while one can begin.
  [[nodiscard]] double trigger() const noexcept;
  /// The latest scans are quiet, at whatever force.
  [[nodiscard]] bool quiet() const noexcept { return quiet_scans_.quiet(); }
  /// What the cell shows now is zero from here on, and no force is left of the last test. Not while a test
  /// runs. \param kept  what was observed since ready(), by the new zero. \return true as arm() does.
  [[nodiscard]] bool tared(std::span<const double> kept);

 private:
  enum class State {
    kWaitingForUnload,  ///< A test is over but the force is not.
    kReady,
    kRunning,
  };

  [[nodiscard]] std::int64_t scans(double seconds) const noexcept;
  /// Follows the unloaded level; not while a test runs.
  void track();
  [[nodiscard]] double base() const noexcept { return UnloadedLevel::of_decisions(level_.value_or(0.0)); }
  /// The force was at the trigger within what is kept.
  [[nodiscard]] bool was_above() const;
  /// A quiet force has just been found, and it is no load of the test.
  [[nodiscard]] bool lies_unloaded();
  /// The force has stayed above the trigger up to now.
  [[nodiscard]] bool loaded() const noexcept { return above_ >= scans(settings_.start_dwell_s); }
  void begin();
  /// \param force  the lowest that was seen since it was a load.
  void wait_for_unload(double force) noexcept;
  /// The force has fallen far enough to be unloaded, and has risen again: for the first time.
  [[nodiscard]] bool pulls_again(double coefficient) noexcept;
  [[nodiscard]] std::optional<double> level_at_end();
  /// Follows turning points and flatness of the running test.
  void follow(double coefficient);
  [[nodiscard]] bool belt_has_stopped() const;

  SegmenterSettings settings_;
  State state_ = State::kReady;
  bool by_force_ = true;
  bool start_now_ = false;
  std::optional<base::ScanIndex> next_;
  UnloadedLevel quiet_scans_;
  UnloadedLevel end_scans_;  ///< Of the dwell that ended the latest test.
  std::optional<double> level_;
  bool level_is_given_;         ///< By a record, for the test to come.
  std::deque<double> waiting_;  ///< As the record will begin with.
  std::int64_t above_ = 0;      ///< Consecutive scans at or above the trigger.
  std::int64_t below_ = 0;      ///< Consecutive scans below the end.

  // Of the running test.
  bool was_loaded_ = false;  ///< The force has stayed above the trigger.
  signal::NoiseEstimator noise_;
  signal::Despiker despiker_;
  detect::FallFinder falls_;
  std::deque<double> end_tail_;  ///< The latest scans, for end_scans_.
  std::optional<double> level_after_;
  bool pulled_again_ = false;
  double lowest_ = 0.0;   ///< Force after a test, averaged over the last few scans.
  double largest_ = 0.0;  ///< Force, averaged over the last few scans.
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
