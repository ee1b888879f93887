/// \file
/// Where commands arrive and answers leave: between the control interface on the main thread and the bench on
/// the processing thread.
#pragma once

#include <functional>
#include <vector>

#include "daemon/calibration_desk.hpp"
#include "daemon/config.hpp"
#include "daemon/control/bench.hpp"
#include "daemon/session.hpp"
#include "daemon/storage.hpp"
#include "daemon/test_log.hpp"

namespace stickslip::daemon {

class BenchDesk final : public Bench {
 public:
  struct Parts {
    DaemonConfig& config;  ///< What is planned and tared stands there, for the next session as well.
    const TestLog& tests;
    Storage& storage;
    CalibrationDesk& calibrations;
    std::function<Status()> status;
    std::function<Session*()> session;                   ///< Null while there is none.
    std::function<void(std::function<void()>)> on_main;  ///< From any thread: to the main thread.
    Batches* batches;
    Reports* reports;
  };
  explicit BenchDesk(Parts parts) : parts_(std::move(parts)), configured_method_(parts_.config.method) {}

  [[nodiscard]] Status status() const override { return parts_.status(); }
  [[nodiscard]] std::vector<TestSummary> tests() const override { return parts_.tests.tests(); }
  [[nodiscard]] Plan plan() const override;
  void set_plan(Plan plan) override;
  void command(Command command, std::function<void(const Outcome&)> answer) override;
  [[nodiscard]] Calibrator& calibrator() override { return parts_.calibrations; }
  [[nodiscard]] Batches& batches() override { return *parts_.batches; }
  [[nodiscard]] Reports& reports() override { return *parts_.reports; }

 private:
  /// Before the processing thread is asked.
  [[nodiscard]] std::optional<std::string> refused_now(Command::Kind kind) const;
  void answered(const Command& command, const Outcome& outcome);

  Parts parts_;
  friction::Method configured_method_;
};

/// What the command does, between two blocks. Processing thread.
[[nodiscard]] Outcome carry_out(const Command& command, pipeline::Processor& processor);

}  // namespace stickslip::daemon
