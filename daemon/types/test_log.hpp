/// \file
/// The latest tests in memory. The processing thread adds tests, the storage threads add their files, the
/// control interface and the final table read.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/analysis/pooled_slips.hpp"
#include "core/analysis/results.hpp"
#include "core/model/truth.hpp"
#include "core/pipeline/sink.hpp"

namespace stickslip::daemon {

/// One finished test.
struct TestSummary {
  std::int64_t number = 0;
  daq::ScanIndex first = 0;
  daq::ScanIndex end = 0;
  pipeline::EndCause cause = pipeline::EndCause::kUnloaded;
  analysis::TestResults results;
  analysis::SlipSums slips;               ///< Sums over S − K of its slips, for pooling over tests.
  std::optional<model::TestTruth> truth;  ///< Truth of a simulated test, without modes and cycles.
  std::string file;                       ///< Path of the record; empty until it is published.
  std::string file_error;                 ///< Why there is no file; empty if there is one.
  /// Recorded by an earlier run of the program and read from its record; its scan indices have another
  /// origin.
  bool earlier = false;
};

/// Tests with each finding, by FindingCode.
using FindingCounts = std::array<std::int64_t, base::kFindingCodes>;

/// Thread-safe.
class TestLog {
 public:
  /// Capacity, tests. The oldest test leaves the log; its record stays.
  static constexpr std::size_t kMaxTests = 1000;

  void add(TestSummary summary);
  /// Adds a test of an earlier run of the program, behind the earlier ones and before this run's own.
  void add_earlier(TestSummary summary);
  /// Sets the path of a test's record and clears its file_error.
  void set_file(std::int64_t number, const std::string& file);
  void set_file_error(std::int64_t number, const std::string& error);

  /// Oldest first.
  [[nodiscard]] std::vector<TestSummary> tests() const;
  /// The latest test of this run of the program.
  [[nodiscard]] std::optional<TestSummary> latest() const;
  /// Tests added since the start of the program.
  [[nodiscard]] std::int64_t test_count() const;
  /// Of the same tests.
  [[nodiscard]] FindingCounts finding_counts() const;

 private:
  [[nodiscard]] TestSummary* find(std::int64_t number);

  mutable std::mutex mutex_;
  std::deque<TestSummary> tests_;
  std::int64_t count_ = 0;
  FindingCounts finding_counts_{};
};

}  // namespace stickslip::daemon
