/// \file
/// A batch: tests planned together, what became of them, and which comes next. Knows neither files nor time.
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

/// What a result may be; none: no limit on that side.
struct ResultLimits {
  std::optional<double> lowest;
  std::optional<double> highest;

  [[nodiscard]] bool holds(double value) const noexcept {
    return !(lowest && value < *lowest) && !(highest && value > *highest);
  }
  bool operator==(const ResultLimits&) const = default;
};

struct BatchPlan {
  record::SampleFacts sample;  ///< Of all its tests; replicate, slide and batch are those of each step.
  std::string method;          ///< As in a record's process/method; empty: that of the daemon.
  std::vector<double> pull_speeds_m_per_s;     ///< In this order; empty: one, whatever the bench has.
  std::int64_t replicates = 1;                 ///< Sheets at each speed, ≥ 1.
  std::int64_t slides = 1;                     ///< Pulls of each sheet, ≥ 1.
  std::map<std::string, ResultLimits> limits;  ///< By the name of the result.

  bool operator==(const BatchPlan&) const = default;
};

/// A batch of more tests is refused.
inline constexpr std::int64_t kMostSteps = 10'000;

/// One test of the plan.
struct BatchStep {
  std::optional<double> pull_speed_m_per_s;
  std::int64_t replicate = 1;
  std::int64_t slide = 1;

  bool operator==(const BatchStep&) const = default;
};

/// All, in the order in which they are made: speed by speed, sheet by sheet, slide by slide.
[[nodiscard]] std::vector<BatchStep> steps(const BatchPlan& plan);

struct BatchTest {
  std::string record;  ///< Its file, from the folder of the journal on.
  BatchStep step;
};

/// Why a test does not count, though its file stays as it is.
struct Voiding {
  std::string reason;
  std::string who;
  std::string at;  ///< ISO 8601.
};

struct Batch {
  std::string id;
  BatchPlan plan;
  std::string who;
  std::string begun_at;
  std::optional<std::string> ended_at;
  std::vector<BatchTest> tests;  ///< As they were recorded.
};

// What can happen; each is a line of the journal.

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
/// Voided by mistake: it counts again.
struct TestRestored {
  std::string record;
};
struct BatchEvent {
  std::string at;   ///< ISO 8601.
  std::string who;  ///< Empty: the daemon itself.
  std::variant<BatchBegun, BatchEnded, TestRecorded, TestVoided, TestRestored> what;
};

/// All batches of a folder of records. A value; events are applied in the order of the journal.
class BatchBook {
 public:
  /// Total: what names a batch that is not known, or says again what is known, changes nothing. A batch that
  /// begins ends the one before.
  void apply(const BatchEvent& event);

  /// The latest, unless it has ended.
  [[nodiscard]] const Batch* current() const noexcept;
  /// By its identifier, or the latest of that sample name.
  [[nodiscard]] const Batch* find(std::string_view id_or_name) const noexcept;
  [[nodiscard]] const std::vector<Batch>& batches() const noexcept { return batches_; }
  /// Null if the test counts.
  [[nodiscard]] const Voiding* voided(const std::string& record) const noexcept;
  [[nodiscard]] bool has(std::string_view batch, std::string_view record) const noexcept;

  /// The first step that no test stands for; none when all are made. A voided test stands for none, so that
  /// it is asked for again. \param under_way  steps of tests that run, or whose file is not published yet.
  [[nodiscard]] std::optional<BatchStep> next_step(const Batch& batch,
                                                   std::span<const BatchStep> under_way) const;

 private:
  [[nodiscard]] Batch* known(std::string_view id) noexcept;

  std::vector<Batch> batches_;
  std::map<std::string, Voiding> voided_;
};

}  // namespace stickslip::daemon
