/// \file
/// State machine of the bench: the table of docs/states.md as a function.
///
///     BenchMachine bench{/*automatic=*/true};
///     if (const std::string_view why_not = bench.observe(BenchEvent::kStart); !why_not.empty())
///     refuse(why_not);
///
/// Knows neither scans nor time nor threads.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace stickslip::pipeline {

enum class BenchState {
  kIdle,       ///< Scans arrive; only a command begins a test.
  kArmed,      ///< The force or a command begins a test.
  kLoading,    ///< A test runs, or begins with the next scan; the force has not fallen.
  kRunning,    ///< A test runs, and the force has fallen; the fall may prove to be no slip.
  kFinishing,  ///< The test is over; the force has not returned to the unloaded level.
  kDegraded,   ///< No scans arrive: the board is missing, busy, or not started.
};
inline constexpr std::size_t kBenchStates = 6;

/// Idle or armed: no test runs, and the bench does not wait for the force of the last one to end. False if
/// degraded.
[[nodiscard]] constexpr bool rests(BenchState state) noexcept {
  return state == BenchState::kIdle || state == BenchState::kArmed;
}

/// Why the bench stays in a state; reported from its detection until another is detected or the state
/// changes.
enum class BenchTrouble {
  kNone,
  kLongFinishing,  ///< For longer than a carriage takes to go back.
  kLongLoading,    ///< For longer than a pull needs to slip.
  kLongRunning,    ///< For longer than a pull takes.
  kLongArmed,      ///< Armed by command, and no pull followed.
  kPulledAgain,    ///< While finishing: such pulls are in no record.
  kNegativeForce,  ///< While armed: the force has the wrong sign, and no pull begins a test.
};

/// Longest normal time in a state, s, and the trouble reported beyond it; kNone: no limit.
struct Patience {
  BenchTrouble trouble = BenchTrouble::kNone;
  double longest_s = 0.0;
};

/// \param automatic  the bench arms itself and waits for the next pull without limit.
[[nodiscard]] Patience patience(BenchState state, bool automatic) noexcept;

/// Description of the trouble with its remedy, for the user; empty for kNone.
[[nodiscard]] std::string_view words(BenchTrouble trouble) noexcept;

/// Inputs of the state machine.
enum class BenchEvent {
  // Commands: each may be refused.
  kArm,
  kStart,
  kStop,
  // Detected from the scans.
  kForceRose,   ///< It stayed above the trigger.
  kSlipped,     ///< The force fell for the first time.
  kForceEnded,  ///< The rule for the end of a test holds.
  kUnloaded,    ///< No force is left of the last test, or somebody tared.
  // Faults.
  kBoardLost,  ///< No more scans.
  kBoardBack,  ///< Scans arrive again, or for the first time.
};
inline constexpr std::size_t kBenchEvents = 9;
/// First event that is not a command.
inline constexpr BenchEvent kFirstNoCommand = BenchEvent::kForceRose;

[[nodiscard]] constexpr std::string_view name(BenchState state) noexcept {
  constexpr std::array<std::string_view, kBenchStates> kNames{"idle",    "armed",     "loading",
                                                              "running", "finishing", "degraded"};
  return kNames[static_cast<std::size_t>(state)];
}

[[nodiscard]] constexpr std::string_view name(BenchEvent event) noexcept {
  constexpr std::array<std::string_view, kBenchEvents> kNames{
      "arm", "start", "stop", "force rose", "slipped", "force ended", "unloaded", "board lost", "board back"};
  return kNames[static_cast<std::size_t>(event)];
}

/// A test is being recorded, or begins with the next scan.
[[nodiscard]] constexpr bool test_runs(BenchState state) noexcept {
  return state == BenchState::kLoading || state == BenchState::kRunning;
}

/// Result of step().
struct BenchStep {
  BenchState next;
  std::string_view refusal;  ///< Reason for refusing a command, for the user; empty: accepted.
};

/// Transition function, defined for every event in every state. Only commands can be refused; any other event
/// without meaning in a state leaves it unchanged.
/// \param automatic  the bench arms itself after a test, and when scans arrive.
[[nodiscard]] BenchStep step(BenchState state, BenchEvent event, bool automatic) noexcept;

/// State of a bench, degraded at first. Thread-bound.
class BenchMachine {
 public:
  explicit BenchMachine(bool automatic) noexcept : automatic_(automatic) {}

  /// \return reason for refusing a command; empty if accepted. A refusal leaves the state unchanged.
  [[nodiscard]] std::string_view observe(BenchEvent event) noexcept {
    const BenchStep taken = step(state_, event, automatic_);
    state_ = taken.next;
    return taken.refusal;
  }
  [[nodiscard]] BenchState state() const noexcept { return state_; }

 private:
  bool automatic_;
  BenchState state_ = BenchState::kDegraded;
};

}  // namespace stickslip::pipeline
