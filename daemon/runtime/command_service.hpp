/// \file
/// Passes commands from the control interface (main thread) to the bench (processing thread), and the answers
/// back.
#pragma once

#include <functional>
#include <vector>

#include "io/config.hpp"

#include "daemon/runtime/calibration_service.hpp"
#include "daemon/runtime/session.hpp"
#include "daemon/storage/storage.hpp"
#include "daemon/types/bench.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::runtime {

class CommandService final : public daemon::Bench {
 public:
  struct Parts {
    io::DaemonConfig& config;  ///< Holds plan and tare; the next session begins with them.
    const daemon::TestLog& tests;
    storage::Storage& storage;
    CalibrationService& calibrations;
    std::function<daemon::Status()> status;
    std::function<Session*()> session;                   ///< Returns null while there is no session.
    std::function<void(std::function<void()>)> on_main;  ///< Runs a function on the main thread. Any thread.
    daemon::Batches* batches;
    daemon::Reports* reports;
    std::function<void(std::function<void(std::string)>)> trend;  ///< As Bench::trend().
  };
  explicit CommandService(Parts parts) : parts_(std::move(parts)), configured_method_(parts_.config.method) {}

  [[nodiscard]] daemon::Status status() const override { return parts_.status(); }
  [[nodiscard]] std::vector<daemon::TestSummary> tests() const override { return parts_.tests.tests(); }
  [[nodiscard]] daemon::Plan plan() const override;
  void set_plan(daemon::Plan plan) override;
  /// Facts of tests that begin later, told by the broker; they replace those of the plan.
  void set_told_facts(record::Metadata facts);
  /// Facts of the next test, by plan and broker.
  [[nodiscard]] record::Metadata next_facts() const {
    return record::merged(parts_.config.sample.metadata, told_facts_);
  }
  void command(daemon::Command command, std::function<void(const daemon::Outcome&)> answer) override;
  [[nodiscard]] daemon::Calibrator& calibrator() override { return parts_.calibrations; }
  [[nodiscard]] daemon::Batches& batches() override { return *parts_.batches; }
  [[nodiscard]] daemon::Reports& reports() override { return *parts_.reports; }
  void trend(std::function<void(std::string)> answer) override { parts_.trend(std::move(answer)); }

 private:
  /// Why the command is refused at once; nothing: the processing thread decides.
  [[nodiscard]] std::optional<std::string> refused_now(daemon::Command::Kind kind) const;
  void answered(const daemon::Command& command, const daemon::Outcome& outcome);

  Parts parts_;
  model::Method configured_method_;
  record::Metadata told_facts_;
};

/// Carries out a command between two blocks. Processing thread.
[[nodiscard]] daemon::Outcome carry_out(const daemon::Command& command, pipeline::Processor& processor);

}  // namespace stickslip::runtime
