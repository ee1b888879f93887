// The states of the bench: the function against the table in docs/states.md, and any sequence of commands and
// faults.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/pipeline/bench_state.hpp"

namespace stickslip::pipeline {
namespace {

std::vector<BenchState> all_states() {
  std::vector<BenchState> states;
  for (std::size_t i = 0; i < kBenchStates; ++i) states.push_back(static_cast<BenchState>(i));
  return states;
}

std::vector<BenchEvent> all_events() {
  std::vector<BenchEvent> events;
  for (std::size_t i = 0; i < kBenchEvents; ++i) events.push_back(static_cast<BenchEvent>(i));
  return events;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream parts{line.substr(1)};
  for (std::string cell; std::getline(parts, cell, '|');) {
    const std::size_t from = cell.find_first_not_of(' ');
    cells.push_back(from == std::string::npos ? ""
                                              : cell.substr(from, cell.find_last_not_of(' ') - from + 1));
  }
  return cells;
}

/// The table of transitions and the list of refusals.
struct Document {
  std::vector<std::string> events;
  std::map<std::string, std::vector<std::string>> rows;
  std::map<std::string, std::string> refusals;  ///< "1" …

  Document() {
    std::ifstream file{STICKSLIP_SOURCE_DIR "/docs/states.md"};
    bool in_table = false;
    for (std::string line; std::getline(file, line);) {
      if (line.starts_with("| | arm")) {
        events = cells_of(line);
        events.erase(events.begin());
        in_table = true;
      } else if (in_table && line.starts_with("| ")) {
        std::vector<std::string> cells = cells_of(line);
        const std::string state = cells.front();
        cells.erase(cells.begin());
        rows[state] = cells;
      } else if (line.size() > 3 && line[0] >= '1' && line[0] <= '9' && line.substr(1, 2) == ". ") {
        refusals[line.substr(0, 1)] = line.substr(3);
      } else if (!line.starts_with("|")) {
        in_table = false;
      }
    }
  }
};

TEST(BenchStates, AreThoseOfTheDocument) {
  const Document document;
  std::set<std::string> refusals_used;
  ASSERT_EQ(document.events.size(), kBenchEvents);
  ASSERT_EQ(document.rows.size(), kBenchStates);
  for (const BenchState state : all_states()) {
    const auto row = document.rows.find(std::string{name(state)});
    ASSERT_NE(row, document.rows.end()) << name(state);
    ASSERT_EQ(row->second.size(), kBenchEvents) << name(state);
    for (const BenchEvent event : all_events()) {
      const auto column = static_cast<std::size_t>(event);
      EXPECT_EQ(document.events[column], name(event));
      for (const bool automatic : {false, true}) {
        const BenchStep taken = step(state, event, automatic);
        std::string cell = row->second[column];
        std::string refusal;
        if (cell.starts_with("refused (")) {
          const std::string number = cell.substr(9, 1);
          refusals_used.insert(number);
          refusal = document.refusals.at(number);
          cell = "–";
        }
        if (cell == "rest") cell = automatic ? "armed" : "idle";
        EXPECT_EQ(name(taken.next), cell == "–" ? name(state) : cell) << name(state) << ", " << name(event);
        EXPECT_EQ(taken.refusal, refusal) << name(state) << ", " << name(event);
      }
    }
  }
  EXPECT_EQ(refusals_used.size(), document.refusals.size()) << "a reason that nothing is refused for";
}

BenchEvent any_event() {
  return static_cast<BenchEvent>(*rc::gen::inRange(0, static_cast<int>(kBenchEvents)));
}

RC_GTEST_PROP(BenchStates, NoSequenceLeavesThem, (bool automatic)) {
  BenchMachine bench{automatic};
  for (int left = *rc::gen::inRange(1, 200); left > 0; --left) {
    const BenchState before = bench.state();
    const BenchEvent event = any_event();
    const std::string_view refusal = bench.observe(event);
    const BenchState after = bench.state();
    RC_ASSERT(static_cast<std::size_t>(after) < kBenchStates);
    RC_ASSERT(!name(after).empty());
    if (!refusal.empty()) {
      RC_ASSERT(event < kFirstNoCommand);
      RC_ASSERT(after == before);
    }
    // Nothing but the board brings the bench out of, and into, the state without scans.
    RC_ASSERT((after == BenchState::kDegraded) ==
              (event == BenchEvent::kBoardLost ||
               (before == BenchState::kDegraded && event != BenchEvent::kBoardBack)));
    // A test begins by force only where it was waited for.
    if (!test_runs(before) && test_runs(after) && event == BenchEvent::kForceRose) {
      RC_ASSERT(before == BenchState::kArmed);
    }
    // And no test begins before the one before is over and unloaded.
    if (before == BenchState::kFinishing) RC_ASSERT(!test_runs(after));
  }
}

// Wherever it is, what people and the world can do brings it back to work.
RC_GTEST_PROP(BenchStates, EveryOneCanBeLeft, (bool automatic)) {
  BenchMachine bench{automatic};
  for (int left = *rc::gen::inRange(0, 50); left > 0; --left) static_cast<void>(bench.observe(any_event()));
  static_cast<void>(bench.observe(BenchEvent::kBoardBack));
  static_cast<void>(bench.observe(BenchEvent::kStop));
  static_cast<void>(bench.observe(BenchEvent::kUnloaded));
  RC_ASSERT(bench.observe(BenchEvent::kArm).empty());
  RC_ASSERT(bench.state() == BenchState::kArmed);
}

}  // namespace
}  // namespace stickslip::pipeline
