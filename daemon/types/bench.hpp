/// \file
/// What people ask of the bench through the control interface, and what becomes of it.
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

/// What the tests to come are of.
struct Plan {
  record::SampleFacts sample;
  std::optional<double> pull_speed_m_per_s;
  std::optional<model::Method> method;  ///< None: that of the configuration.

  bool operator==(const Plan&) const = default;
};

struct Command {
  enum class Kind { kArm, kStart, kStop, kMark, kTare };
  Kind kind = Kind::kArm;
  std::string who;
  std::string text;  ///< Of a mark.
  std::optional<std::int64_t>
      test;  ///< Of start and stop: the test that is meant. What it asks may be done already.
};

struct Outcome {
  pipeline::TareReport report;  ///< Of a command that is no tare: its first part.
  bool already = false;         ///< It had been done before.
};

/// What the control interface knows of the daemon. Main thread.
class Bench {
 public:
  virtual ~Bench() = default;

  [[nodiscard]] virtual Status status() const = 0;
  /// Oldest first.
  [[nodiscard]] virtual std::vector<TestSummary> tests() const = 0;
  [[nodiscard]] virtual Plan plan() const = 0;
  /// For the tests that begin from here on. \param plan  checked.
  virtual void set_plan(Plan plan) = 0;
  /// \param answer  called on the main thread, once: at once, or when the processing thread has done it.
  virtual void command(Command command, std::function<void(const Outcome&)> answer) = 0;
  /// Of the load cell. Outlives the bench.
  [[nodiscard]] virtual Calibrator& calibrator() = 0;
  /// Lives as long as this.
  [[nodiscard]] virtual Batches& batches() = 0;
  /// Lives as long as this.
  [[nodiscard]] virtual Reports& reports() = 0;
};

}  // namespace stickslip::daemon
