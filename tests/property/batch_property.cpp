// Whatever happens in a batch, it leads to each planned test once, and its journal tells the same story
// again.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "daemon/types/batch.hpp"
#include "daemon/types/batch_json.hpp"

namespace stickslip::daemon {
namespace {

BatchPlan some_plan() {
  BatchPlan plan;
  plan.sample.name = "liner";
  plan.replicates = *rc::gen::inRange<std::int64_t>(1, 4);
  plan.slides = *rc::gen::inRange<std::int64_t>(1, 4);
  const auto speeds = *rc::gen::inRange(0, 3);
  for (int i = 1; i <= speeds; ++i) plan.pull_speeds_m_per_s.push_back(0.001 * i);
  return plan;
}

BatchEvent event(decltype(BatchEvent::what) what) {
  return {"2026-11-22T12:00:00+00:00", "ada", std::move(what)};
}

RC_GTEST_PROP(Batch, LeadsToEachPlannedTestOnceWhateverIsVoidedOrRestored, ()) {
  const BatchPlan plan = some_plan();
  const std::vector<BatchStep> planned = steps(plan);
  BatchBook book;
  std::vector<std::string> lines;
  const auto happens = [&](decltype(BatchEvent::what) what) {
    lines.push_back(line_of(event(what)));
    book.apply(event(std::move(what)));
  };
  happens(BatchBegun{"b", plan});
  std::vector<std::string> records;
  std::vector<BatchStep> under_way;
  const auto counts_at = [&](const BatchStep& step) {
    const auto& tests = book.current()->tests;
    return std::count_if(tests.begin(), tests.end(),
                         [&](const BatchTest& test) {
                           return test.step == step && book.voided(test.record) == nullptr;
                         }) +
           std::count(under_way.begin(), under_way.end(), step);
  };
  const int length = *rc::gen::inRange(0, 60);
  for (int i = 0; i < length; ++i) {
    const auto next = book.next_step(*book.current(), under_way);
    switch (*rc::gen::inRange(0, 4)) {
      case 0:
        if (next) under_way.push_back(*next);
        break;
      case 1:  // The oldest of those under way is recorded, or was not to be.
        if (under_way.empty()) break;
        if (*rc::gen::inRange(0, 4) > 0) {
          records.push_back("r" + std::to_string(records.size()));
          happens(TestRecorded{"b", {records.back(), under_way.front()}});
        }
        under_way.erase(under_way.begin());
        break;
      default:
        if (records.empty()) break;
        const std::string& record = records[*rc::gen::inRange<std::size_t>(0, records.size())];
        // What is restored after its step was made again counts twice: people's wish, not the leader's.
        if (book.voided(record) == nullptr) {
          happens(TestVoided{record, "torn"});
        } else if (counts_at(std::find_if(book.current()->tests.begin(), book.current()->tests.end(),
                                          [&](const BatchTest& test) { return test.record == record; })
                                 ->step) == 0) {
          happens(TestRestored{record});
        }
    }
    const auto now = book.next_step(*book.current(), under_way);
    for (const BatchStep& step : planned) {
      RC_ASSERT(counts_at(step) <= 1);
      // All before the next are made, and the next is not.
      if (now && step == *now) break;
      RC_ASSERT(counts_at(step) == 1);
    }
    if (now) RC_ASSERT(counts_at(*now) == 0);
  }
  BatchBook again;
  for (const std::string& line : lines) {
    const auto read = event_of(line);
    RC_ASSERT(read.has_value());
    again.apply(*read);
  }
  RC_ASSERT(again.next_step(*again.current(), under_way) == book.next_step(*book.current(), under_way));
  RC_ASSERT(again.current()->plan == plan);
  for (const std::string& record : records)
    RC_ASSERT((again.voided(record) == nullptr) == (book.voided(record) == nullptr));
}

}  // namespace
}  // namespace stickslip::daemon
