#include "daemon/runtime/command_service.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/record/method_text.hpp"

namespace stickslip::runtime {
namespace {

/// The outcome of a start or stop whose named test has begun or ended already, or cannot; nothing if the
/// command must be carried out.
std::optional<daemon::Outcome> done_already(const daemon::Command& command,
                                            const pipeline::Processor& processor) {
  if (!command.test) return std::nullopt;
  const std::int64_t meant = *command.test;
  const std::int64_t next = processor.test_number();
  daemon::Outcome outcome;
  outcome.report.state = processor.bench();
  outcome.report.test = meant;
  const bool begun = pipeline::test_runs(processor.bench());
  const bool starts = command.kind == daemon::Command::Kind::kStart;
  if (meant < next || (starts && begun && meant == next)) {
    outcome.already = true;
    return outcome;
  }
  if (starts && meant > next) {
    outcome.report.refusal = fmt::format("test {} cannot begin: the next is test {}", meant, next);
    return outcome;
  }
  if (!starts && (meant > next || !begun)) {
    outcome.report.refusal = fmt::format("test {} has not begun", meant);
    return outcome;
  }
  return std::nullopt;
}

daemon::Outcome of(pipeline::CommandReport report) {
  daemon::Outcome outcome;
  static_cast<pipeline::CommandReport&>(outcome.report) = std::move(report);
  return outcome;
}

}  // namespace

daemon::Outcome carry_out(const daemon::Command& command, pipeline::Processor& processor) {
  if (auto done = done_already(command, processor)) return *std::move(done);
  switch (command.kind) {
    case daemon::Command::Kind::kArm:
      return of(processor.arm(command.who));
    case daemon::Command::Kind::kStart:
      return of(processor.start(command.who));
    case daemon::Command::Kind::kStop:
      return of(processor.stop(command.who));
    case daemon::Command::Kind::kMark:
      return of(processor.mark(command.text));
    case daemon::Command::Kind::kTare:
      break;
  }
  return {processor.tare(command.who), false};
}

daemon::Plan CommandService::plan() const {
  daemon::Plan plan{parts_.config.sample, parts_.config.bench.pull_speed_m_per_s, std::nullopt};
  if (!(parts_.config.method == configured_method_)) plan.method = parts_.config.method;
  return plan;
}

void CommandService::set_plan(daemon::Plan plan) {
  parts_.config.sample = plan.sample;
  // A speed that nobody planned is known from the scene or the replayed record.
  const bool new_speed = parts_.config.bench.pull_speed_m_per_s != plan.pull_speed_m_per_s;
  parts_.config.bench.pull_speed_m_per_s = plan.pull_speed_m_per_s;
  parts_.config.method = plan.method.value_or(configured_method_);
  Session* const session = parts_.session();
  if (session == nullptr) return;
  plan.sample.metadata = next_facts();
  // A session that is over takes it from the configuration.
  static_cast<void>(session->post([&storage = parts_.storage, plan = std::move(plan), new_speed,
                                   method = parts_.config.method](pipeline::Processor& processor) {
    if (new_speed) processor.plan_pull_speed(plan.pull_speed_m_per_s);
    processor.plan_method(method);
    storage.amend([&](record::RecordHeader& header) {
      header.sample = plan.sample;
      if (new_speed) header.tester.pull_speed_m_per_s = plan.pull_speed_m_per_s;
      header.process.method = record::method_text(method);
    });
  }));
}

void CommandService::set_told_facts(record::Metadata facts) {
  told_facts_ = std::move(facts);
  Session* const session = parts_.session();
  if (session == nullptr) return;
  static_cast<void>(
      session->post([&storage = parts_.storage, next = next_facts()](pipeline::Processor& /*processor*/) {
        storage.amend([&next](record::RecordHeader& header) { header.sample.metadata = next; });
      }));
}

std::optional<std::string> CommandService::refused_now(daemon::Command::Kind kind) const {
  const bool test = kind == daemon::Command::Kind::kArm || kind == daemon::Command::Kind::kStart;
  if (test || kind == daemon::Command::Kind::kTare) {
    if (auto why_not = parts_.calibrations.why_no_test()) return why_not;
  }
  return test ? daemon::why_no_test(parts_.storage.state()) : std::nullopt;
}

void CommandService::command(daemon::Command command, std::function<void(const daemon::Outcome&)> answer) {
  if (auto why_not = refused_now(command.kind)) {
    daemon::Outcome outcome;
    outcome.report.refusal = *std::move(why_not);
    outcome.report.state = parts_.status().bench;
    answer(outcome);
    return;
  }
  Session* const session = parts_.session();
  const bool posted =
      session != nullptr && session->post([this, command, answer](pipeline::Processor& processor) {
        const daemon::Outcome outcome = carry_out(command, processor);
        if (command.kind == daemon::Command::Kind::kTare && outcome.report.refusal.empty()) {
          parts_.storage.amend([&outcome](record::RecordHeader& header) {
            if (header.load_cell) header.load_cell->zero_V = outcome.report.zero_V;
          });
        }
        parts_.on_main([this, command, answer, outcome] {
          answered(command, outcome);
          answer(outcome);
        });
      });
  if (posted) return;
  daemon::Outcome outcome;
  outcome.report.refusal =
      pipeline::step(pipeline::BenchState::kDegraded, pipeline::BenchEvent::kStart, false).refusal;
  answer(outcome);
}

void CommandService::answered(const daemon::Command& command, const daemon::Outcome& outcome) {
  if (command.kind == daemon::Command::Kind::kTare && outcome.report.refusal.empty()) {
    parts_.config.bench.load_cell_zero_V = outcome.report.zero_V;
  }
}

}  // namespace stickslip::runtime
