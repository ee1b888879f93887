#include "daemon/types/test_log.hpp"

#include <algorithm>

namespace stickslip::daemon {

void TestLog::add(TestSummary summary) {
  // A day of slips would take megabytes, and these tables are not used here.
  if (summary.truth) {
    summary.truth->modes.clear();
    summary.truth->cycles.clear();
  }
  const std::lock_guard lock{mutex_};
  ++count_;
  for (const base::FindingKind& kind : base::finding_kinds()) {
    const auto& findings = summary.results.findings;
    if (std::any_of(findings.begin(), findings.end(), [&](const auto& own) { return own.code == kind.name; }))
      ++finding_counts_[static_cast<std::size_t>(kind.code)];
  }
  tests_.push_back(std::move(summary));
  if (tests_.size() > kMaxTests) tests_.pop_front();
}

void TestLog::add_earlier(TestSummary summary) {
  const std::lock_guard lock{mutex_};
  if (tests_.size() >= kMaxTests) return;
  const auto own =
      std::find_if(tests_.begin(), tests_.end(), [](const TestSummary& test) { return !test.earlier; });
  tests_.insert(own, std::move(summary));
}

TestSummary* TestLog::find(std::int64_t number) {
  const auto found = std::find_if(tests_.rbegin(), tests_.rend(),
                                  [number](const TestSummary& test) { return test.number == number; });
  return found == tests_.rend() ? nullptr : &*found;
}

void TestLog::set_file(std::int64_t number, const std::string& file) {
  const std::lock_guard lock{mutex_};
  if (TestSummary* test = find(number)) {
    test->file = file;
    test->file_error.clear();
  }
}

void TestLog::set_file_error(std::int64_t number, const std::string& error) {
  const std::lock_guard lock{mutex_};
  if (TestSummary* test = find(number)) test->file_error = error;
}

std::vector<TestSummary> TestLog::tests() const {
  const std::lock_guard lock{mutex_};
  return {tests_.begin(), tests_.end()};
}

std::optional<TestSummary> TestLog::latest() const {
  const std::lock_guard lock{mutex_};
  if (tests_.empty() || tests_.back().earlier) return std::nullopt;
  return tests_.back();
}

FindingCounts TestLog::finding_counts() const {
  const std::lock_guard lock{mutex_};
  return finding_counts_;
}

std::int64_t TestLog::test_count() const {
  const std::lock_guard lock{mutex_};
  return count_;
}

}  // namespace stickslip::daemon
