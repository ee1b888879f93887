/// \file
/// A batch: tests planned together, their records, and the test that comes next. Pure data: no files, no
/// clock.
///
///     BatchBook book;
///     book.apply({.at = …, .who = "ada", .what = BatchBegun{id, plan}});
///     book.next_step(*book.current(), {});   // → the first pull of the first sheet
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/record/record.hpp"

namespace stickslip::daemon {

/// Limits of a result. An absent side has no limit.
struct ResultLimits {
  std::optional<double> lowest;
  std::optional<double> highest;

  [[nodiscard]] bool holds(double value) const noexcept {
    return !(lowest && value < *lowest) && !(highest && value > *highest);
  }
  bool operator==(const ResultLimits&) const = default;
};

struct BatchPlan {
  record::SampleFacts sample;  ///< Shared by all tests; each step sets its replicate, slide and batch.
  /// Test method as in a record's process/method; empty: that of the daemon.
  std::string method;
  std::vector<double> pull_speeds_m_per_s;     ///< In this order; empty: the bench's one.
  std::int64_t replicates = 1;                 ///< Sheets at each speed, ≥ 1.
  std::int64_t slides = 1;                     ///< Pulls of each sheet, ≥ 1.
  std::map<std::string, ResultLimits> limits;  ///< Key: name of the result.

  bool operator==(const BatchPlan&) const = default;
};

/// Most tests in one batch.
inline constexpr std::int64_t kMostSteps = 10'000;

/// One test of the plan.
struct BatchStep {
  std::optional<double> pull_speed_m_per_s;
  std::int64_t replicate = 1;
  std::int64_t slide = 1;

  bool operator==(const BatchStep&) const = default;
};

/// All steps, in the order of measurement: the slides of a sheet, the sheets of a speed, the speeds.
[[nodiscard]] std::vector<BatchStep> steps(const BatchPlan& plan);

struct BatchTest {
  std::string record;  ///< Path of its file, relative to the folder of the batch journal.
  BatchStep step;
};

/// A test that was voided: it does not count. Its record stays unchanged.
struct Voiding {
  std::string reason;
  std::string who;
  std::string at;  ///< ISO 8601.

  bool operator==(const Voiding&) const = default;
};

struct Batch {
  std::string id;
  BatchPlan plan;
  std::string who;
  std::string begun_at;
  std::optional<std::string> ended_at;
  std::vector<BatchTest> tests;  ///< In the order of recording.
};

// The events of a batch; each is a line of the batch journal.

struct BatchBegun {
  std::string batch;
  BatchPlan plan;
};
struct BatchEnded {
  std::string batch;
};
struct TestRecorded {
  std::string batch;
  BatchTest test;
};
struct TestVoided {
  std::string record;
  std::string reason;
};
/// Undoes TestVoided: the test counts again.
struct TestRestored {
  std::string record;
};
struct BatchEvent {
  std::string at;   ///< ISO 8601.
  std::string who;  ///< Name of the controller; empty: the daemon itself.
  std::variant<BatchBegun, BatchEnded, TestRecorded, TestVoided, TestRestored> what;
};

/// All batches of a record folder, built from the events of their journal in order.
class BatchBook {
 public:
  /// Applies one event. An event about an unknown batch, or one that repeats an earlier event, changes
  /// nothing. BatchBegun ends the batch before.
  void apply(const BatchEvent& event);

  /// The latest batch, or null if it has ended or there is none.
  [[nodiscard]] const Batch* current() const noexcept;
  /// The batch of this identifier, else the latest one of this sample name, else null.
  [[nodiscard]] const Batch* find(std::string_view id_or_name) const noexcept;
  [[nodiscard]] const std::vector<Batch>& batches() const noexcept { return batches_; }
  /// The voiding of a test, or null if the test counts. \param record  as BatchTest::record.
  [[nodiscard]] const Voiding* voided(const std::string& record) const noexcept;
  /// All tests that are void, by the same names.
  [[nodiscard]] const std::map<std::string, Voiding>& voidings() const noexcept { return voided_; }
  /// True if the batch has a test with this record.
  [[nodiscard]] bool has(std::string_view batch, std::string_view record) const noexcept;

  /// The first step without a test that counts; nothing if every step has one. A step whose test was voided
  /// is due again. \param under_way  steps of tests that run or whose record is not published yet; they are
  /// not due.
  [[nodiscard]] std::optional<BatchStep> next_step(const Batch& batch,
                                                   std::span<const BatchStep> under_way) const;

 private:
  [[nodiscard]] Batch* known(std::string_view id) noexcept;

  std::vector<Batch> batches_;
  std::map<std::string, Voiding> voided_;
};

}  // namespace stickslip::daemon
