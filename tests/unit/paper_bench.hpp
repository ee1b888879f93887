/// \file
/// A bench that does what it is told, on paper.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/control/bench.hpp"

namespace stickslip::daemon {

inline Status some_status() {
  Status status;
  status.state = "acquiring";
  status.scan_count = 42;
  status.board.emplace();
  status.board->scan_rate_granted_Hz = 350.0;
  status.latest_test.emplace();
  status.latest_test->number = 7;
  status.latest_test->results.mu_s = friction::Estimate::of(0.35);
  status.latest_test->results.mu_k = friction::Estimate::none("no slip");
  status.bench = pipeline::BenchState::kRunning;
  status.live.emplace();
  status.live->phase = friction::Phase::kCycles;
  status.live->regime = friction::Regime::kStickSlip;
  status.live->latest.emplace();
  status.live->latest->S = 0.36;
  status.storage.kind = StorageState::Kind::kShort;
  status.storage.room_h = 0.1;
  status.storage.why = "room for 6 min of tests, 10 are wanted";
  return status;
}

class PaperBench final : public Bench {
 public:
  [[nodiscard]] Status status() const override { return some_status(); }
  [[nodiscard]] std::vector<TestSummary> tests() const override { return {*some_status().latest_test}; }
  [[nodiscard]] Plan plan() const override { return plan_; }
  void set_plan(Plan plan) override { plan_ = std::move(plan); }
  void command(Command command, std::function<void(const Outcome&)> answer) override {
    commands.push_back(command);
    if (later) {
      waiting = [answer, refusal = refusal] { answer(outcome(refusal)); };
    } else {
      answer(outcome(refusal));
    }
  }
  static Outcome outcome(const std::string& refusal) {
    Outcome outcome;
    outcome.report.refusal = refusal;
    outcome.report.state = pipeline::BenchState::kLoading;
    outcome.report.test = 8;
    outcome.report.scan = 1234;
    return outcome;
  }

  std::vector<Command> commands;
  std::string refusal;
  bool later = false;
  std::function<void()> waiting;

 private:
  Plan plan_;
};

}  // namespace stickslip::daemon
