/// \file
/// What the bench is doing, and what may come next: the table of docs/states.md as a function.
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
  kIdle,       ///< Scans come; nothing but a command begins a test.
  kArmed,      ///< The force or a command begins a test.
  kLoading,    ///< A test runs and no slip has been seen.
  kRunning,    ///< A test runs, and at least one slip has been seen.
  kFinishing,  ///< The test is over; its force is still there.
  kDegraded,   ///< No scans come: the board is missing, busy, or has not begun.
};
inline constexpr std::size_t kBenchStates = 6;

/// No test runs, and no force of the last one is left.
[[nodiscard]] constexpr bool rests(BenchState state) noexcept {
  return state == BenchState::kIdle || state == BenchState::kArmed;
}

/// What keeps a bench from the tests to come; told when it is seen, and until the state changes.
enum class BenchTrouble {
  kNone,
  kLongFinishing,  ///< For longer than a carriage takes to go back.
  kLongLoading,    ///< For longer than a pull needs to slip.
  kLongRunning,    ///< For longer than a pull takes.
  kLongArmed,      ///< Somebody armed it, and no pull came.
  kPulledAgain,    ///< While finishing: such pulls are in no record.
};

/// What it is to be in the state for so long, in seconds, that somebody should look; kNone: no trouble.
struct Patience {
  BenchTrouble trouble = BenchTrouble::kNone;
  double longest_s = 0.0;
};

/// \param automatic  the bench arms itself, and waits for the next pull as long as it takes.
[[nodiscard]] Patience patience(BenchState state, bool automatic) noexcept;

/// What it is, and what helps. Empty for kNone.
[[nodiscard]] std::string_view words(BenchTrouble trouble) noexcept;

/// What can happen to it.
enum class BenchEvent {
  // Commands: each may be refused.
  kArm,
  kStart,
  kStop,
  // What the scans show.
  kForceRose,   ///< It stayed above the trigger.
  kSlipped,     ///< The force fell for the first time.
  kForceEnded,  ///< The rule for the end of a test holds.
  kUnloaded,    ///< No force is left of the last test.
  // Faults.
  kBoardLost,  ///< No more scans.
  kBoardBack,  ///< Scans come again, or for the first time.
};
inline constexpr std::size_t kBenchEvents = 9;
/// Those before it are commands.
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

/// A test is being recorded.
[[nodiscard]] constexpr bool test_runs(BenchState state) noexcept {
  return state == BenchState::kLoading || state == BenchState::kRunning;
}

struct BenchStep {
  BenchState next;
  std::string_view refusal;  ///< Why a command is refused, for people; empty: it is not.
};

/// Total: each event in each state has its step. What is no command is never refused; where it means nothing
/// the state stays.
/// \param automatic  after a test, and when scans come, the bench arms itself.
[[nodiscard]] BenchStep step(BenchState state, BenchEvent event, bool automatic) noexcept;

/// Thread-bound.
class BenchMachine {
 public:
  explicit BenchMachine(bool automatic) noexcept : automatic_(automatic) {}

  /// \return why the event, a command, is refused; empty if it is not. A refusal changes nothing.
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
