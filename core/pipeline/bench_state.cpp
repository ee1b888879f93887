#include "core/pipeline/bench_state.hpp"

namespace stickslip::pipeline {
namespace {

constexpr std::string_view kTestRuns = "a test is running; stop it first";
constexpr std::string_view kStillLoaded =
    "the force of the last test is still there; let the carriage go back, or tare where nothing pulls";
constexpr std::string_view kNothingToStop = "no test is running, and none is waited for";
constexpr std::string_view kAlreadyOver = "the test is over already";
constexpr std::string_view kNoBoard = "no scans come from the board; stickslip status says why";

BenchStep idle(BenchEvent event) noexcept {
  switch (event) {
    case BenchEvent::kArm:
      return {BenchState::kArmed, {}};
    case BenchEvent::kStart:
      return {BenchState::kLoading, {}};
    case BenchEvent::kStop:
      return {BenchState::kIdle, kNothingToStop};
    default:
      return {BenchState::kIdle, {}};
  }
}

BenchStep armed(BenchEvent event) noexcept {
  switch (event) {
    case BenchEvent::kStart:
    case BenchEvent::kForceRose:
      return {BenchState::kLoading, {}};
    case BenchEvent::kStop:
      return {BenchState::kIdle, {}};
    default:
      return {BenchState::kArmed, {}};
  }
}

/// Loading or running.
BenchStep in_test(BenchState state, BenchEvent event) noexcept {
  switch (event) {
    case BenchEvent::kArm:
    case BenchEvent::kStart:
      return {state, kTestRuns};
    case BenchEvent::kStop:
    case BenchEvent::kForceEnded:
      return {BenchState::kFinishing, {}};
    case BenchEvent::kSlipped:
      return {BenchState::kRunning, {}};
    default:
      return {state, {}};
  }
}

BenchStep finishing(BenchEvent event, BenchState at_rest) noexcept {
  switch (event) {
    case BenchEvent::kArm:
    case BenchEvent::kStart:
      return {BenchState::kFinishing, kStillLoaded};
    case BenchEvent::kStop:
      return {BenchState::kFinishing, kAlreadyOver};
    case BenchEvent::kUnloaded:
      return {at_rest, {}};
    default:
      return {BenchState::kFinishing, {}};
  }
}

BenchStep degraded(BenchEvent event, BenchState at_rest) noexcept {
  if (event == BenchEvent::kBoardBack) return {at_rest, {}};
  return {BenchState::kDegraded, event < kFirstNoCommand ? kNoBoard : std::string_view{}};
}

}  // namespace

BenchStep step(BenchState state, BenchEvent event, bool automatic) noexcept {
  const BenchState at_rest = automatic ? BenchState::kArmed : BenchState::kIdle;
  if (event == BenchEvent::kBoardLost) return {BenchState::kDegraded, {}};
  switch (state) {
    case BenchState::kIdle:
      return idle(event);
    case BenchState::kArmed:
      return armed(event);
    case BenchState::kLoading:
    case BenchState::kRunning:
      return in_test(state, event);
    case BenchState::kFinishing:
      return finishing(event, at_rest);
    case BenchState::kDegraded:
      break;
  }
  return degraded(event, at_rest);
}

Patience patience(BenchState state, bool automatic) noexcept {
  switch (state) {
    case BenchState::kFinishing:
      return {BenchTrouble::kLongFinishing, 10.0};  // A carriage is back by then.
    case BenchState::kLoading:
      return {BenchTrouble::kLongLoading, 60.0};  // A sled has slipped, or slides steadily.
    case BenchState::kRunning:
      return {BenchTrouble::kLongRunning, 600.0};  // 0.5 m at 1 mm/s take 500 s.
    case BenchState::kArmed:
      if (!automatic) return {BenchTrouble::kLongArmed, 600.0};
      break;
    case BenchState::kIdle:
    case BenchState::kDegraded:  // That of the daemon, which tells it.
      break;
  }
  return {};
}

std::string_view words(BenchTrouble trouble) noexcept {
  switch (trouble) {
    case BenchTrouble::kNone:
      break;
    case BenchTrouble::kLongFinishing:
      return "the force of the last test is still there, and no test can begin: let the carriage go back, "
             "or, if nothing pulls, stickslip tare";
    case BenchTrouble::kLongLoading:
      return "a test runs and no slip has been seen: if nothing pulls, stickslip stop, then stickslip tare";
    case BenchTrouble::kLongRunning:
      return "a test is still running: where the belt stands or the sled is off, stickslip stop ends it";
    case BenchTrouble::kLongArmed:
      return "no pull has come since the bench was armed: pull, or stickslip stop to let it be";
    case BenchTrouble::kPulledAgain:
      return "the sled was pulled before the force of the last test was gone, and while that lasts no pull "
             "is recorded: leave the unloaded sled at rest for a second before each pull";
    case BenchTrouble::kNegativeForce:
      return "the force has been as far below zero as a test begins above it, and no such pull is recorded: "
             "if the "
             "sled was pulled, change the sign of load_cell_gain or swap the cell's signal wires and "
             "calibrate; if "
             "nothing pulls, stickslip tare";
  }
  return {};
}

}  // namespace stickslip::pipeline
