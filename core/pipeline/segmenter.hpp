/// \file
/// Segmenter: finds where tests begin and end in a stream of scans.
///
///     Segmenter segmenter{settings};
///     if (segmenter.observe(index, coefficient) == Segmenter::Event::kTestStarts) …
///
/// A test begins when the force stays above a trigger, or by command. It ends by command, when the force
/// stays near zero again (the carriage has returned), or when a full oscillation stops within a period and
/// the force lies flat (the belt has stopped with the coupling stretched).
/// Trigger and end threshold are relative to the level of the unloaded cell, which quiet scans give
/// (unloaded_level.hpp). Before a test each quiet force up to UnloadedLevel::kFarthest is that level; during
/// and after a test only one that is also at most a third of the largest force. The level is 0 until it is
/// known; until then a test begins only at kFarthest or more if no pre-trigger scan is below the trigger.
///
/// An oscillation that decays into a flat force does not end a test: the sled slides steadily, and the force
/// does not show whether the belt still moves.
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

/// Coefficients are force over normal load. A dwell counts as at least two scans.
struct SegmenterSettings {
  double scan_rate_Hz = 350.0;
  double step_coefficient = 0.0;    ///< One A/D step; 0 if unknown.
  double start_coefficient = 0.05;  ///< Trigger, above the unloaded level.
  double start_dwell_s = 0.010;     ///< Time at or above the trigger that begins a test.
  double end_coefficient = 0.02;    ///< End threshold, above the unloaded level; < start_coefficient.
  /// Time below the end threshold that ends a test; must exceed the slack part of a cycle.
  double unload_dwell_s = 0.25;
  double no_motion_dwell_s = 0.5;  ///< Time of flat force that ends a test; four periods if they are longer.
  double pre_trigger_s = 0.25;     ///< Longest part of the record before the trigger scan.

  /// Unloaded level at the first scan, if a record gives it; holds through the first test. Ignored
  /// beyond UnloadedLevel::kFarthest.
  std::optional<double> unloaded_level = {};

  /// Largest number of scans before the trigger scan that belong to the record. After a gap, a test, arm() or
  /// tared(), and at the beginning, there may be fewer.
  [[nodiscard]] std::size_t pre_trigger_scans() const noexcept;
};

/// Deterministic. Decisions during a test depend only on the scans of its record, the unloaded level before
/// it (SegmenterSettings::unloaded_level) and commands, so that a replay with all three ends at the same
/// scan. Thread-bound.
class Segmenter {
 public:
  enum class Event {
    kNone,
    kTestStarts,        ///< A test begins; this is its trigger scan.
    kUnloaded,          ///< Last scan of a test: the force is near the unloaded level again.
    kNoRelativeMotion,  ///< Last scan of a test: the belt has stopped.
    kPulledAgain,       ///< Rose again before unloading was detected; begins no test. Once a test.
    /// As far below the unloaded level as a test begins above it, for the unload dwell: the force has the
    /// wrong sign. Only where force may begin a test; once for each such stretch, but for the first after a
    /// test: there the carriage may push the sled back.
    kNegative,
  };

  /// \throws std::invalid_argument unless rate and dwells are positive, pre_trigger_s ≥ 0 and
  ///         0 ≤ end_coefficient < start_coefficient.
  explicit Segmenter(const SegmenterSettings& settings);

  /// Enables or disables the trigger by force; initially enabled. No effect on a running test.
  void trigger_by_force(bool on) noexcept { by_force_ = on; }
  /// Enables the trigger by force from the next scan on.
  /// \return true if the force was at the trigger within the pre-trigger time already. The pre-trigger scans
  /// are then discarded: a replay, which does not know the time of this call, would have begun the test
  /// there.
  [[nodiscard]] bool arm();
  /// Begins a test with the next scan, whatever its force; no effect unless ready(). Unloading ends this test
  /// only after the force has stayed above the trigger.
  void start() noexcept;
  /// Ends the running test with the latest scan, or cancels a pending start().
  void stop() noexcept;

  /// Takes the next scan. \param index rises; a jump discards the pre-trigger scans.
  [[nodiscard]] Event observe(base::ScanIndex index, double coefficient);

  /// Whether a test can begin. False during a test, and until the force of the last one has returned to the
  /// unloaded level.
  [[nodiscard]] bool ready() const noexcept { return state_ == State::kReady; }

  /// A test has started and not ended.
  [[nodiscard]] bool running() const noexcept { return state_ == State::kRunning; }

  /// Present level of the unloaded cell, from quiet scans or the settings; 0 after a tare, nullopt if
  /// unknown.
  [[nodiscard]] std::optional<double> unloaded_level() const noexcept { return level_; }
  /// Unloaded level at the end of the latest test; nullopt while a test runs, and unless the test ended with
  /// kUnloaded and a quiet force.
  [[nodiscard]] std::optional<double> level_after() const noexcept { return level_after_; }
  /// Present coefficient at and above which a force begins a test; it changes with the scans. While the
  /// unloaded level is unknown and no pre-trigger scan is below start_coefficient, at least
  /// UnloadedLevel::kFarthest.
  [[nodiscard]] double trigger() const noexcept;
  /// Whether the latest scans are quiet, at any force.
  [[nodiscard]] bool quiet() const noexcept { return quiet_scans_.quiet(); }
  /// Adopts a new zero after a tare; ready() holds afterwards. Not while a test runs.
  /// \param kept  the pre-trigger scans, as coefficients with the new zero.
  /// \return true if one of them was at the trigger; all are then discarded, as by arm().
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
  /// Whether the force was at the trigger within the pre-trigger scans.
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
  std::int64_t negative_ = 0;   ///< Consecutive scans as far below the level as the trigger is above it.
  bool may_push_back_ = false;  ///< A pull has loaded the cell, and no negative stretch followed.

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
