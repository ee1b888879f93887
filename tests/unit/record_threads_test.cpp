// The threads that make a record of a trace: rows are split beside their reading, slips are detected beside
// the fits, and the scans are written meanwhile. Under ThreadSanitizer.

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/evaluation/analyse.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "tests/unit/traces_sample.hpp"

namespace stickslip::traces {
namespace {

using RecordThreads = Traces;

/// A saw-tooth of five slips a second at 1 kHz, with a hash of the row as noise.
std::string saw_tooth(int rows) {
  std::string text = "t (s),F\n";
  for (int i = 0; i < rows; ++i) {
    const double phase = (i % 200) / 200.0;
    const double level = phase < 0.9 ? 0.27 + 0.08 * phase / 0.9
                                     : 0.31 + 0.04 * std::cos(std::numbers::pi * (phase - 0.9) / 0.1);
    const auto hash = static_cast<unsigned>(i) * 2654435761U;
    text += fmt::format("{:.3f},{:.6f}\n", 0.001 * i, level + 1e-3 * (hash / 4294967296.0 - 0.5));
  }
  return text;
}

TEST_F(RecordThreads, MakeTheRecordThatOneThreadMakes) {
  // Several blocks of each column: most of them lie in the scratch files that the threads share.
  constexpr int kRows = 6 * static_cast<int>(base::LongColumn<double>::kBlock);
  request_.tester.pull_speed_m_per_s = 0.001;
  request_.scratch_folder = folder_.path();
  const auto imported = import(saw_tooth(kRows));
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_EQ(imported->tests.size(), 1U);
  record::Record record = imported->tests[0].record;
  const record::ColumnScans& scans = imported->tests[0].scans;
  const auto alone = evaluation::analyse(test::in_memory(imported->tests[0]));
  ASSERT_TRUE(alone) << alone.error().message;
  ASSERT_GT(alone->cycles.size(), 0U);

  const auto published = record::publish_record(record, scans, folder_ / "a.h5", [&, own = scans.view()] {
    return evaluation::analyse(record, own, request_.scratch_folder);
  });
  ASSERT_TRUE(published) << published.error().message;
  const auto read = record::read_record(folder_ / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->scan.size(), static_cast<std::size_t>(kRows));
  EXPECT_EQ(read->end->results, alone->results);
}

}  // namespace
}  // namespace stickslip::traces
