/// \file
/// Interface between the control interface and the bench.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/scan_index.hpp"
#include "core/model/method.hpp"
#include "core/pipeline/command_report.hpp"
#include "core/record/record.hpp"
#include "daemon/types/batches.hpp"
#include "daemon/types/calibrator.hpp"
#include "daemon/types/reports.hpp"
#include "daemon/types/status.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::daemon {

/// What the coming tests measure, and how.
struct Plan {
  record::SampleFacts sample;
  std::optional<double> pull_speed_m_per_s;
  std::optional<model::Method> method;  ///< Absent: the one of the configuration.

  bool operator==(const Plan&) const = default;
};

struct Command {
  enum class Kind { kArm, kStart, kStop, kMark, kTare };
  Kind kind = Kind::kArm;
  std::string who;
  std::string text;  ///< Text of a mark.
  /// Of start and stop: number of the test that is to begin or end, so that a repeated command does nothing.
  std::optional<std::int64_t> test;
};

struct Outcome {
  /// The CommandReport part is valid for all commands, the rest for a tare only.
  pipeline::TareReport report;
  bool already = false;  ///< The named test had begun or ended already; nothing was done.
};

/// The daemon as the control interface sees it. Main thread.
class Bench {
 public:
  virtual ~Bench() = default;

  [[nodiscard]] virtual Status status() const = 0;
  /// The latest tests, oldest first.
  [[nodiscard]] virtual std::vector<TestSummary> tests() const = 0;
  [[nodiscard]] virtual Plan plan() const = 0;
  /// Sets the plan of the tests that begin later. \param plan  must be valid, as from plan_of().
  virtual void set_plan(Plan plan) = 0;
  /// Gives a command; does not block. \param answer  called once, on the main thread: at once if the command
  /// is refused, else when the processing thread has carried it out.
  virtual void command(Command command, std::function<void(const Outcome&)> answer) = 0;
  /// Calibration of the load cell. Outlives this object.
  [[nodiscard]] virtual Calibrator& calibrator() = 0;
  /// Lives as long as this object.
  [[nodiscard]] virtual Batches& batches() = 0;
  /// Lives as long as this object.
  [[nodiscard]] virtual Reports& reports() = 0;
  /// Gives the control charts of the tester, with what was changed in their files until now, as
  /// trend_course_json() writes them; does not block. \param answer  called once, on the main thread.
  virtual void trend(std::function<void(std::string)> answer) = 0;
};

}  // namespace stickslip::daemon
