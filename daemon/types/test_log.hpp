/// \file
/// What became of the latest tests: the processing thread adds, the storage thread says where
/// the file is, control and report read.
#pragma once

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
  analysis::SlipSums slips;               ///< S − K of its slips, for tests together.
  std::optional<model::TestTruth> truth;  ///< Without modes and cycles.
  std::string file;                       ///< Empty until the file is published.
  std::string file_error;                 ///< Why there is no file; empty if there is one.
  bool earlier =
      false;  ///< Of before the program began: read from its record. Its scans count from another 0.
};

/// Thread-safe.
class TestLog {
 public:
  /// Tests kept; older ones are forgotten (their files are not).
  static constexpr std::size_t kMaxTests = 1000;

  void add(TestSummary summary);
  /// One of before the program began, in their order; before those that it made itself.
  void add_earlier(TestSummary summary);
  /// What was in the way before is forgotten.
  void set_file(std::int64_t number, const std::string& file);
  void set_file_error(std::int64_t number, const std::string& error);

  /// Oldest first.
  [[nodiscard]] std::vector<TestSummary> tests() const;
  /// Of this program's own.
  [[nodiscard]] std::optional<TestSummary> latest() const;
  /// Since the start of the program.
  [[nodiscard]] std::int64_t test_count() const;

 private:
  [[nodiscard]] TestSummary* find(std::int64_t number);

  mutable std::mutex mutex_;
  std::deque<TestSummary> tests_;
  std::int64_t count_ = 0;
};

}  // namespace stickslip::daemon
