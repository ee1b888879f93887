// A record from a foreign trace: values, unit, sign, rate, holes and what was left out; else one line that
// says what is missing.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "io/traces/inspect.hpp"

#include "tests/unit/traces_sample.hpp"

namespace stickslip::traces {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

using TraceImport = Traces;

/// Rows from..to of time and value, at 100 Hz.
std::string rows(int from, int to) {
  std::string text;
  for (int i = from; i < to; ++i) text += fmt::format("{:.2f},{}\n", 0.01 * i, 1 + i);
  return text;
}

std::vector<double> values(int count) {
  std::vector<double> result;
  for (int i = 0; i < count; ++i) result.push_back(1 + i);
  return result;
}

TEST_F(TraceImport, TakesTheValuesOfTheNamedColumn) {
  const auto record = expect_values("t_s,F\n0.000,0.25\n0.001,-1e-3\n0.002,+3\n", {0.25, -0.001, 3.0});
  EXPECT_THAT(record.scan, ElementsAre(0, 1, 2));
  EXPECT_NEAR(record.header.board.scan_rate_granted_Hz, 1000.0, 1e-6);
  EXPECT_EQ(record.header.title, "trace");
}

TEST_F(TraceImport, TellsWhichPartOfTheFileHasBeenRead) {
  std::vector<double> parts;
  request_.progress = [&parts](double part) { parts.push_back(part); };
  ASSERT_TRUE(import("t (s),F\n" + rows(0, 100'000)));  // 1.3 MB, in blocks.
  // Once for the look at the file, once for all of it.
  const auto whole = std::find(parts.begin(), parts.end(), 1.0);
  ASSERT_NE(whole, parts.end());
  EXPECT_GT(parts.front(), 0.0);
  EXPECT_LT(parts.front(), 0.5);
  EXPECT_TRUE(std::is_sorted(std::prev(whole, 3), whole));
}

TEST_F(TraceImport, HolesAndMissingRowsAreGaps) {
  const auto record = expect_values("t (s),F\n0.000,1\n0.010,\n0.020,3\n0.040,5\n0.050,6\n0.060,7\n",
                                    {1.0, 3.0, 5.0, 6.0, 7.0});
  EXPECT_THAT(record.scan, ElementsAre(0, 2, 4, 5, 6));
  EXPECT_EQ(record.gaps.size(), 2U);
}

TEST_F(TraceImport, LastLineNeedsNoEndButIsLeftOutIfItWasCut) {
  expect_values("t (s),F\n0.00,1.5\n0.01,2.5\n0.02,3.5", {1.5, 2.5, 3.5});
  expect_values("t (s),F\n0.00,1.5\n0.01,2.5\n0.02,3.", {1.5, 2.5});
  EXPECT_THAT(report_, HasSubstr("line 4 left out"));
}

TEST_F(TraceImport, FootersAndRepeatedHeadingsAreLeftOut) {
  expect_values("t (s),F\n" + rows(0, 5) + "\nMean,2\nEnd\n", values(5));
  EXPECT_THAT(report_, HasSubstr("left out: no scans"));
  expect_values("t,F\ns,1\n" + rows(0, 25) + "t,F\ns,1\n" + rows(25, 29) + ",\n" + rows(29, 40), values(40));
  EXPECT_THAT(report_, HasSubstr("heading or its units again"));
}

// Below another heading the columns are not what they were.
TEST_F(TraceImport, HeadingsOrUnitsThatChangeAreRefused) {
  std::string first = "t,F,x\ns,1,mm\n";
  for (int i = 0; i < 20; ++i) first += fmt::format("{:.2f},{},7\n", 0.01 * i, 1 + i);
  const std::string scans = "0.00,1,2\n0.01,3,4\n";
  expect_refused(first + "Run 2\nt,x,F\ns,mm,1\n" + scans,
                 ":24: another heading, with 'x' in column 2 where line 1 has 'F': put this table, "
                 "with its heading, into a file of its own");
  expect_refused(first + "t,F,y\ns,1,mm\n" + scans,
                 ":23: another heading, with 'y' in column 3 where line 1 has 'x'");
  expect_refused(first + "Run 2\nt,F,x\n(ms),(1),(mm)\n" + scans,
                 ":25: another row of units, with '(ms)' in column 1 where line 2 has 's'");
  expect_refused("t (s),F (1)\n" + rows(0, 20) + "\nt (s),F (%)\n" + rows(0, 5),
                 ":23: another heading, with 'F (%)' in column 2 where line 1 has 'F (1)'");
  std::string longer = "t (s),x,F\n";
  for (int i = 0; i < 200; ++i) longer += fmt::format("{:.2f},7,{}\n", 0.01 * i, 1 + i);
  expect_refused("t (s),F\n" + rows(0, 300) + longer, ":302: another heading, with 'x' in column 2");
  expect_values("t,F\ns,1\n" + rows(0, 25) + "Run 1\nt,F\n(s),(1)\n" + rows(25, 40), values(40));
  expect_values("t,F\ns,1\n" + rows(0, 25) + "F,peak\n", values(25));
  // Of scans, not of units.
  expect_values("t,F\ns,1\n0,5\n1,1\n2,5\n", {5.0, 1.0, 5.0});
  request_.unit = "coefficient";
  request_.rate_Hz = 100.0;
  for (const char* const unit : {"coefficient", "[1]"})
    expect_values(fmt::format("F\n{}\n0.98\n1\n1.01\n1\n", unit), {0.98, 1.0, 1.01, 1.0});
  // A rule below the heading is none of it.
  std::string ruled = "F\n---\n";
  for (int i = 0; i < 30; ++i) ruled += i == 10 ? "---\n" : fmt::format("{}\n", 0.01 * (30 + i));
  expect_refused(ruled, ":13: column 'F' is '---', and scans follow in line 14");
  request_.rate_Hz.reset();
  const std::string frame = "|t (s)|F|\n|---|---|\n";
  std::string framed;
  for (int i = 0; i < 40; ++i)
    framed += (i % 25 == 0 ? frame : "") + fmt::format("|{:.2f}|{}|\n", 0.01 * i, 1 + i);
  expect_values(framed, values(40));
  request_.rate_Hz.reset();
  std::string cases = "t (s),F,f\n";
  for (int i = 0; i < 20; ++i) cases += fmt::format("{:.2f},{},2\n", 0.01 * i, 1 + i);
  expect_refused(cases + "t (s),f,F\n0.20,2,1\n0.21,2,1\n", "another heading, with 'f' in column 2");
  // Words that mean the same, and a third row of a heading.
  request_.unit = "N";
  expect_values("t,F\ns,N\n" + rows(0, 25) + "T,f\nsec,Newton\n" + rows(25, 40), values(40));
  std::string joined;
  for (int i = 0; i < 40; ++i) {
    if (i % 25 == 0) joined += "\"TOA5\",\"logger\"\nTIME,RECORD,F\nTS,RN,N\n,,Avg\n";
    joined += fmt::format("2026-11-25 12:00:00.{:02},{},{}\n", i, i, 1 + i);
  }
  expect_values(joined, values(40));
  expect_refused("t,F\ns,mN\n" + rows(0, 25) + "t,F\ns,kN\n" + rows(25, 40),
                 "another row of units, with 'kN'");
}

// A row of statistics may have a time that could be one.
TEST_F(TraceImport, StatisticsWithAPlausibleTimeAreLeftOut) {
  std::string blank = "Note,t (s),F\n";
  std::string clock = "Clock,t (s),F\n";
  std::string counted = "Point,t (s),F\n";
  for (int i = 0; i < 20; ++i) {
    blank += fmt::format(",{:.2f},{}\n", 0.01 * i, 1 + i);
    clock += fmt::format("12:00:00.{:02},{:.2f},{}\n", i, 0.01 * i, 1 + i);
    counted += fmt::format("{},{:.2f},{}\n", i, 0.01 * i, 1 + i);
  }
  request_.time_column = "t (s)";
  for (const std::string& content : {blank, clock}) {
    expect_values(content + "Last,0.20,7\nMean,0.21,10.5\n", values(20));
    EXPECT_THAT(report_, HasSubstr("2 lines from line 22 on left out: a word stands before the numbers"));
  }
  expect_values(counted + "Last,0.20,7\nMean,0.21,10.5\n", values(20));
  EXPECT_THAT(report_, HasSubstr("2 lines from line 22 on left out"));
  // A word at the first row of each run is none.
  expect_values("Run,t (s),F\nA,0.00,1\n,0.01,2\n,0.02,3\nB,0.03,4\n,0.04,5\n", values(5));
}

// Words in the last rows of a column that has words above are events.
TEST_F(TraceImport, EventsInTheLastRowsAreScans) {
  std::string content = "Event,t (s),F\n";
  for (int i = 0; i < 20; ++i) {
    const char* const event = i == 4 ? "peak" : i == 18 ? "stop" : i == 19 ? "end" : "";
    content += fmt::format("{},{:.2f},{}\n", event, 0.01 * i, 1 + i);
  }
  expect_values(content, values(20));
}

TEST_F(TraceImport, TextBetweenScansIsRefused) {
  expect_refused(
      "t (s),F\n" + rows(0, 5) + "0.05,abc\n" + rows(6, 9),
      ":7: column 'F' is 'abc', and scans follow in line 8: a number is needed there; correct the line, "
      "or remove it");
  expect_refused("t (s),F\n" + rows(0, 5) + "\nSlip,Peak\n1,8\n2,9\n",
                 "correct the line, or remove it and those below it if they are no scans");
}

TEST_F(TraceImport, TheCellThatIsNoNumberIsShown) {
  expect_refused("t (s),T,F\n0.00,5,1\n0.01,5,1\n0.02,5,1\n0.03,ERR,1\n0.04,5,1\n0.05,5,1\n",
                 ":5: column 'T' is 'ERR', and scans follow in line 6");
  std::string wider = "t (s),F\n" + rows(0, 150);
  for (int i = 150; i < 300; ++i) wider += fmt::format("{:.2f},7,{}\n", 0.01 * i, i);
  expect_refused(wider,
                 ":152: there is '150' in column 3, and the table has 2, and the 150 lines from there");
}

TEST_F(TraceImport, LongTablesAreReadInPiecesThatDoNotShow) {
  expect_values("t (s),F\n" + rows(0, 40'000) + "\"400.00\",\"40001\n\"\n", values(40'001));
  expect_refused("t (s),F\n" + rows(0, 20'000) + "event,x\n" + rows(20'000, 40'000),
                 ":20002: column 'F' is 'x', and scans follow in line 20003");
  expect_refused(
      "t (s),F\n" + rows(0, 20'000) + "event,x\n" + rows(20'000, 20'001) + std::string(2 << 20, '1'),
      ":20002: column 'F' is 'x', and scans follow in line 20003");
  expect_refused("t (s),F\n" + rows(0, 20'000) + std::string(2 << 20, '1'), ":20002: the line is longer");
}

// As where a program changed its decimal mark.
TEST_F(TraceImport, HalfATraceIsNoFooter) {
  std::string content = "t (s);F\n";
  for (int i = 0; i < 400; ++i) content += fmt::format("{:.4f};1{}25\n", 0.01 * i, i < 200 ? '.' : ',');
  expect_refused(content, ":202: column 'F' is '1,25', and the 200 lines from there to the end are like it");
}

TEST_F(TraceImport, ClockThatStartsAgainIsAnotherRecord) {
  const auto imported = import("t (s),F\n" + rows(0, 50) + "Run 2\nt (s),F\n" + rows(0, 50));
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_EQ(imported->tests.size(), 2U);
  EXPECT_EQ(test::in_memory(imported->tests[1]).raw, values(50));
}

TEST_F(TraceImport, RunsInReverseAreEachTurnedRound) {
  std::string content = "t (s),F\n";
  for (const double offset : {100.0, 0.0}) {  // The later run stands first.
    for (int i = 49; i >= 0; --i) content += fmt::format("{:.2f},{}\n", 0.01 * i, offset + 1 + i);
  }
  request_.reverse = true;
  const auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_EQ(imported->tests.size(), 2U);
  EXPECT_EQ(test::in_memory(imported->tests[0]).raw, values(50));
  EXPECT_EQ(test::in_memory(imported->tests[1]).raw.front(), 101.0);
  EXPECT_EQ(test::in_memory(imported->tests[1]).raw.back(), 150.0);
}

TEST_F(TraceImport, ClockMayPassMidnight) {
  const auto record = expect_values("Time,F\n23:59:59.98,1\n23:59:59.99,2\n00:00:00.00,3\n00:00:00.01,4\n",
                                    {1.0, 2.0, 3.0, 4.0});
  EXPECT_THAT(record.scan, ElementsAre(0, 1, 2, 3));
}

TEST_F(TraceImport, DatesBeyondNanosecondsGiveNoStart) {
  const auto far =
      expect_values("Time,F\n9999-01-01T00:00:00.00Z,1\n9999-01-01T00:00:00.01Z,2\n", {1.0, 2.0});
  EXPECT_FALSE(far.header.start_realtime_ns);
  const auto near =
      expect_values("Time,F\n2026-01-01T00:00:00.00Z,1\n2026-01-01T00:00:00.01Z,2\n", {1.0, 2.0});
  EXPECT_EQ(near.header.start_realtime_ns, 1'767'225'600'000'000'000);
}

TEST_F(TraceImport, UnitOfTheHeadingIsComparedWithTheStatedOne) {
  request_.unit = "N";
  expect_refused("t (s),F (cN)\n" + rows(0, 5), "is in cN, --unit says N: give --unit cN");
  expect_refused("t (s),F (g)\n" + rows(0, 5), "is in g, --unit says N: give --unit gf");
  expect_refused("t (s),F (kg)\n" + rows(0, 5), "is in kg, --unit says N: give --unit kgf");
  expect_refused("t (s),F (Volt)\n" + rows(0, 5), "give --unit V");
  expect_refused("t (s),F (mm)\n" + rows(0, 5), "is in mm, which --unit N is not");
  expect_values("t (s),F (Newton)\n" + rows(0, 5), values(5));
}

TEST_F(TraceImport, UnitOfTheHeadingIsOneOfForce) {
  for (const std::string unit : {"kp", "Newton", "NEWTONS", "lbs", "Kgf", "gF", "lbF", "kgF", "ozF"}) {
    request_.unit.clear();
    const auto imported = import("t (s),F [" + unit + "]\n" + rows(0, 5));
    EXPECT_TRUE(imported) << imported.error().message;
    request_.unit = unit;
    EXPECT_TRUE(import("t (s),F [" + unit + "]\n" + rows(0, 5))) << unit;
  }
  request_.unit.clear();
  expect_refused("t (s),F (grams)\n" + rows(0, 5),
                 "column \"F (grams)\" is in grams, which is no unit of force: give --unit gf");
  expect_refused("t (s),F (lb)\n" + rows(0, 5), "give --unit lbf");
  expect_refused("t (s),F (Nx10)\n" + rows(0, 5), "give --unit, such as N");
  expect_refused("t (s),F (mm)\n" + rows(0, 5), "choose another column");
  EXPECT_THAT(quantity_unit("grams").error().message, HasSubstr("shown in grams is in gf"));
  EXPECT_THAT(quantity_unit("lb").error().message, HasSubstr("shown in lb is in lbf"));
}

// What is said of a row names its line in the file, though the rows are read from the last to the first.
TEST_F(TraceImport, ReversedRowsKeepTheirLines) {
  request_.reverse = true;
  const std::string content = "t (s),F\n0.0500,6\n0.0400,5\n0.0300,4\n0.0300,4\n0.0100,2\n0.0000,1\n";
  expect_refused(content, "trace.csv:4: ");
  request_.skip_doubled = true;
  expect_values(content, {1.0, 2.0, 4.0, 5.0, 6.0});
}

TEST_F(TraceImport, ReversedRowsStartWithTheFirstScan) {
  request_.reverse = true;
  const auto record = expect_values(
      "Time,F\n2026-01-01T00:00:01.00Z,3\n2026-01-01T00:00:00.50Z,2\n2026-01-01T00:00:00.00Z,1\n",
      {1.0, 2.0, 3.0});
  EXPECT_EQ(record.header.start_realtime_ns, 1'767'225'600'000'000'000);
}

/// Rows of two pulls of 30 s at 10 scans/s, the second 40 s after the first: "2026-01-01T00:MM:SS.sZ,force".
/// \param hours_between  more, between their clocks. \param decimals  of the seconds.
std::vector<std::string> two_pulls(int hours_between, int decimals) {
  std::vector<std::string> rows;
  for (int i = 0; i < 1200; ++i) {
    const bool pulled = (i >= 100 && i < 400) || (i >= 800 && i < 1100);
    const std::string seconds =
        fmt::format("{:02}{}", i / 10 % 60, decimals > 0 ? fmt::format(".{}", i % 10) : "");
    rows.push_back(fmt::format("2026-01-01T{:02}:{:02}:{}Z,{:.4f}\n", i < 600 ? 0 : hours_between, i / 600,
                               seconds, (pulled ? 0.3 : 0.0) + 1e-4 * (i * 7919 % 13)));
  }
  return rows;
}

constexpr std::int64_t kNewYear_ns = 1'767'225'600'000'000'000;
constexpr std::int64_t kScan_ns = 100'000'000;

// Each test of a trace starts when its own first scan was read.
TEST_F(TraceImport, TestsOfOneTraceHaveTheirOwnStarts) {
  std::vector<std::string> rows = two_pulls(0, 1);
  for (const bool reverse : {false, true}) {
    request_.reverse = reverse;
    if (reverse) std::ranges::reverse(rows);
    const auto imported = import(fmt::format("Time,F\n{}", fmt::join(rows, "")));
    ASSERT_TRUE(imported) << imported.error().message;
    ASSERT_THAT(imported->tests, SizeIs(2));
    const record::Record second = test::in_memory(imported->tests[1]);
    EXPECT_EQ(imported->tests[0].record.header.start_realtime_ns, kNewYear_ns);
    EXPECT_GT(second.scan.front(), 400);
    EXPECT_EQ(second.header.start_realtime_ns, kNewYear_ns + kScan_ns * second.scan.front());
  }
}

// A clock that shows whole seconds tells no rate; it does tell that an hour without rows has passed.
TEST_F(TraceImport, ATestBehindAPauseStartsByItsOwnRow) {
  request_.rate_Hz = 10.0;
  const auto imported = import(fmt::format("Time,F\n{}", fmt::join(two_pulls(1, 0), "")));
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_THAT(imported->tests, SizeIs(2));
  const base::ScanIndex first = test::in_memory(imported->tests[1]).scan.front();
  EXPECT_GT(first, 36'000);
  EXPECT_TRUE(imported->tests[0].record.gaps.empty() ? imported->tests[1].record.gaps.front().estimated
                                                     : imported->tests[0].record.gaps.front().estimated);
  EXPECT_THAT(imported->report, HasSubstr("scans are missing where the time column jumps"));
  // Within the resolution of the clock.
  EXPECT_NEAR(static_cast<double>(*imported->tests[1].record.header.start_realtime_ns - kNewYear_ns),
              1e8 * static_cast<double>(first), 1e9);
}

// Times of so few digits tell missing rows but no rate: scan indices run ahead of the rows.
TEST_F(TraceImport, ATestBehindMissingRowsStartsByItsScan) {
  request_.rate_Hz = 7.0;
  std::string content = "Time,F\n";
  for (int i = 0; i < 2400; ++i) {
    if (i > 440 && i < 1960) continue;
    const bool pulled = (i >= 100 && i < 400) || (i >= 2000 && i < 2300);
    const int tenths = (i * 10 + 3) / 7;
    content += fmt::format("2026-01-01T00:{:02}:{:02}.{}Z,{:.4f}\n", tenths / 600, tenths / 10 % 60,
                           tenths % 10, (pulled ? 0.3 : 0.0) + 1e-4 * (i * 7919 % 13));
  }
  const auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_THAT(imported->tests, SizeIs(2));
  const base::ScanIndex first = test::in_memory(imported->tests[1]).scan.front();
  EXPECT_GT(first, 440);
  // Within the last digit of the times.
  EXPECT_NEAR(static_cast<double>(*imported->tests[1].record.header.start_realtime_ns - kNewYear_ns),
              1e9 / 7.0 * static_cast<double>(first), 1e8);
}

// Runs one below the other, the newest first.
TEST_F(TraceImport, ARunOfAnEarlierDateHasItsOwnStart) {
  std::string content = "Time,F\n";
  for (const int day : {2, 1}) {
    for (int i = 0; i < 200; ++i)
      content += fmt::format("2026-01-{:02}T00:00:{:02}.{}Z,0.{}\n", day, i / 10, i % 10, 1 + i % 3);
  }
  const auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  ASSERT_THAT(imported->tests, SizeIs(2));
  EXPECT_EQ(imported->tests[0].record.header.start_realtime_ns, kNewYear_ns + 86'400 * 10 * kScan_ns);
  EXPECT_EQ(imported->tests[1].record.header.start_realtime_ns, kNewYear_ns);
}

TEST_F(TraceImport, UnitThatChangesBetweenCellsIsRefused) {
  request_.unit = "N";
  expect_refused("t (s),F\n0.00,1\n0.01,2\n0.02,3000 mN\n0.03,4000 mN\n",
                 ":4: column 'F' is '3000 mN', the rows before are in no unit");
}

TEST_F(TraceImport, NegativeForceNeedsInvert) {
  const std::string content = "t (s),F\n0.00,-1\n0.01,-2\n0.02,-2\n";
  expect_refused(content, "give --invert");
  request_.invert = true;
  const auto imported = import(content);
  EXPECT_TRUE(imported) << imported.error().message;
}

// Names that count scans elsewhere.
TEST_F(TraceImport, CurrentIsNoCounter) {
  request_.rate_Hz = 100.0;
  std::string content = "I (A),F\n";
  for (int i = 0; i < 100; ++i) content += fmt::format("{},{}\n", i == 50 ? std::string{} : "0.501", 0.3);
  const auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(imported->tests.front().scans.size(), 100U);
}

TEST_F(TraceImport, PreambleWithAnotherMarkAboveAHeadingIsNone) {
  std::string content = "Mass;0.200\nSpeed;2.5\nStiffness;0.9\nTime;F\n";
  for (int i = 0; i < 100; ++i) content += fmt::format("12:00:{:02},{:03};1,2345\n", i / 10, i % 10 * 100);
  const auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(imported->report, HasSubstr("heading in line 4"));
}

// A test, then a start without load that was given up, or the other way round.
TEST_F(TraceImport, RunWithoutLoadTellsNoSign) {
  std::string test;
  std::string unloaded;
  for (int i = 0; i < 200; ++i) {
    test += fmt::format("{:.2f},{}\n", 0.01 * i, i < 50 ? 0.0 : 0.3);
    unloaded += fmt::format("{:.2f},{}\n", 0.01 * i, i % 2 == 0 ? 0.001 : -0.004);
  }
  for (const auto& [content, line] : {std::pair{test + unloaded, 202}, std::pair{unloaded + test, 2}}) {
    const auto imported = import("t (s),F\n" + content);
    ASSERT_TRUE(imported) << imported.error().message;
    EXPECT_EQ(imported->tests.size(), 2U);
    EXPECT_THAT(
        imported->report,
        HasSubstr(fmt::format("the run of line {} has hardly any load, -0.004 as a coefficient", line)));
  }
}

TEST_F(TraceImport, NegativeForceIsToldInALongTraceToo) {
  std::string content = "F\n";
  for (int i = 0; i < 200'000; ++i) content += i % 100 < 60 ? "-1\n" : "0\n";
  request_.rate_Hz = 350.0;
  expect_refused(content, "the force is negative while sliding, -1 as a coefficient: give --invert");
}

TEST_F(TraceImport, CountsKeepTheirCodesAndTheirScale) {
  request_.unit = "counts";
  request_.load_cell = daq::LoadCell{2.0, 0.0};
  request_.counts = count_scale("-32768..32767", 0.5e-3).value();
  const auto imported = import("t (s),F\n0.00,-32768\n0.01,0\n0.02,32767\n0.03,2000\n");
  ASSERT_TRUE(imported) << imported.error().message;
  const record::Record record = test::in_memory(imported->tests.front());
  const daq::BoardInfo& board = record.header.board;
  EXPECT_EQ(board.quantity, daq::RawQuantity::kCounts);
  EXPECT_EQ(board.maxdata, 65535U);
  EXPECT_DOUBLE_EQ(board.range_min_V, -16.384);
  EXPECT_DOUBLE_EQ(board.range_max_V, 16.3835);
  EXPECT_THAT(record.raw, ElementsAre(0.0, 32768.0, 65535.0, 34768.0));
  const daq::Calibration calibration{board, *record.header.load_cell, 1.0};
  EXPECT_DOUBLE_EQ(calibration.volts(record.raw[3]), 1.0);
  EXPECT_DOUBLE_EQ(calibration.force_N(record.raw[3]), 2.0);
  EXPECT_TRUE(calibration.saturated(record.raw[0]));
  EXPECT_FALSE(calibration.saturated(record.raw[1]));
}

TEST_F(TraceImport, CountsThatCannotBeAreRefusedWithTheirRow) {
  request_.unit = "counts";
  const std::string content = "t (s),F\n" + rows(0, 5);
  expect_refused(content, "--unit counts needs --count-range and --volts-per-count");
  request_.counts = count_scale("0..4", 1e-3).value();
  expect_refused(content, "--unit counts needs --load-cell-gain");
  request_.load_cell = daq::LoadCell{2.0, 0.0};
  expect_refused(content,
                 ":6: column \"F\" is 5, and counts are whole numbers of 0 … 4: correct --count-range");
  request_.counts = count_scale("0..255", 1e-3).value();
  expect_refused("t (s),F\n0.00,1\n0.01,1.5\n",
                 ":3: column \"F\" is 1.5, and counts are whole numbers of 0 … 255: correct --unit");
  request_.resample = true;
  expect_refused(content, "--resample makes numbers between the counts");
  request_.resample = false;
  request_.unit = "V";
  expect_refused(content, "are for --unit counts, the unit is V");
}

TEST(CountScale, IsARangeOfCodes) {
  EXPECT_EQ(count_scale("0..4294967295", 1.0)->highest, 4294967295);
  for (const char* wrong : {"", "..", "0", "0..", "..5", "5..5", "5..0", "0..4294967296", "0...5", "0..5.5",
                            "a..b", "0..9999999999999"}) {
    const auto scale = count_scale(wrong, 1.0);
    ASSERT_FALSE(scale) << wrong;
    EXPECT_THAT(scale.error().message, HasSubstr("--count-range: "));
  }
}

TEST_F(TraceImport, UnitOfTheTimeIsItsHeadingsOrFoundByInspection) {
  std::string content = "millis,F\n";
  std::string since_1970 = "timestamp,F\n";
  std::string minutes = "Time (Min),F\n";
  std::string hours = "Time (hours),F\n";
  std::string seconds = "Time (Sekunden),F\n";
  for (int i = 0; i < 200; ++i) {
    content += fmt::format("{},{}\n", 10 * i, 1);
    since_1970 += fmt::format("17000000{:02}{:02}0000000,1\n", i / 100, i % 100);
    minutes += fmt::format("{:.8f},{}\n", 0.01 * i / 60.0, 1);
    hours += fmt::format("{:.10f},{}\n", 0.01 * i / 3600.0, 1);
    seconds += fmt::format("{:.2f},{}\n", 0.01 * i, 1);
  }
  for (const std::string& text : {content, "time" + content.substr(6), "Time (mSec)" + content.substr(6),
                                  minutes, hours, "Time (hr)" + hours.substr(12), seconds, since_1970}) {
    const auto imported = import(text);
    ASSERT_TRUE(imported) << imported.error().message;
    EXPECT_NEAR(imported->tests[0].record.header.board.scan_rate_granted_Hz, 100.0, 0.01);
  }
}

TEST_F(TraceImport, UnitsInTheCellsOfTheTimeCount) {
  const std::vector<double> three{1.0, 2.0, 3.0};
  for (const char* const content :
       {"Time,F\n990 ms,1\n995 ms,2\n1.000 s,3\n", "t (s),F\n0 ms,1\n5 ms,2\n10 ms,3\n",
        "t,F\n0 msec,1\n5 msec,2\n10 msec,3\n"})
    EXPECT_NEAR(expect_values(content, three).header.board.scan_rate_granted_Hz, 200.0, 1e-6);
  expect_refused("t,F\n0 ms,1\n5,2\n10 ms,3\n",
                 "trace.csv:3: column 't' is '5': a time has one of the units");
  expect_refused("t,F\n0 cs,1\n5 cs,2\n10 cs,3\n", "trace.csv:2: column 't' is '0 cs'");
}

// Windows counts 100 ns since 1601. LabVIEW's seconds since 1904 look like those of a year to come.
TEST_F(TraceImport, TimesOfOtherEpochsAreKnownOrTellNoStart) {
  std::string windows = "Timestamp,F\n";
  std::string labview = "Time,F\n";
  std::string steps = "Time,F\n";
  for (int i = 0; i < 2000; ++i) {
    windows += fmt::format("1317215520{:08},1\n", 50000 * i);
    labview += fmt::format("36105264{:02}.{:03},1\n", i / 200, 5 * (i % 200));
    steps += fmt::format("{},1\n", i);
  }
  request_.now_ns = kNewYear_ns;
  auto imported = import(windows);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_NEAR(imported->tests[0].record.header.board.scan_rate_granted_Hz, 200.0, 0.01);
  EXPECT_NEAR(static_cast<double>(*imported->tests[0].record.header.start_realtime_ns), 1'527'681'600e9, 1e6);
  imported = import(labview);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_FALSE(imported->tests[0].record.header.start_realtime_ns);
  EXPECT_THAT(imported->report, HasSubstr("no start time"));
  imported = import(steps);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(imported->report, HasSubstr("in ms, by inspection: 1000 Hz; --time-unit s would be 1 Hz"));
}

TEST_F(TraceImport, ADateThatCannotBeReadIsToldAndMayNotChangeUnseen) {
  std::string content = "Time,F\n";
  for (int i = 0; i < 60; ++i) content += fmt::format("25.11.26 23:59:{:02},{}\n", i, 1 + i);
  auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(imported->report, HasSubstr("dates such as 25.11.26 are not read"));
  // At midnight it changes.
  imported = import(content + "26.11.26 00:00:00,61\n26.11.26 00:00:01,62\n");
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(test::in_memory(imported->tests[0]).scan.back(), 61);
  EXPECT_THAT(imported->report, Not(HasSubstr("the date becomes")));
  std::string lost = "Time,F\n";
  for (int i = 0; i < 30; ++i) lost += fmt::format("2{}.11.26 10:00:{:02},{}\n", i < 20 ? 5 : 6, i, 1 + i);
  imported = import(lost);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(imported->report,
              HasSubstr("line 22: the date becomes 26.11.26 where the clock does not pass midnight"));
}

TEST_F(TraceImport, TimeOfTheWholeTestIsPreferredToThatOfItsCycles) {
  const auto record =
      expect_values("Total Time (s),Cycle Elapsed Time (s),F\n0.0,0.0,1\n0.1,0.1,2\n0.2,0.0,3\n0.3,0.1,4\n",
                    {1.0, 2.0, 3.0, 4.0});
  EXPECT_THAT(record.scan, ElementsAre(0, 1, 2, 3));
}

// Ten rows are lost; the counter tells, beside a clock of whole seconds too.
TEST_F(TraceImport, CounterTellsMissingRows) {
  request_.rate_Hz = 100.0;
  for (const char* const name :
       {"Sample #", "Scan No.", "Points", "Lfd. Nr.", "N°", "RECORD", "Zähler", "Point number", "#", "idx"}) {
    for (const bool clock : {false, true}) {
      std::string content = fmt::format("\"{}\",{}F\n", name, clock ? "Time," : "");
      for (int i = 0; i < 500; ++i) {
        if (i < 310 || i >= 320)
          content += fmt::format("{},{}1\n", i, clock ? fmt::format("12:00:0{},", i / 100) : "");
      }
      const auto imported = import(content);
      ASSERT_TRUE(imported) << imported.error().message;
      EXPECT_THAT(imported->tests[0].record.gaps, SizeIs(1)) << name << clock;
      EXPECT_EQ(test::in_memory(imported->tests[0]).scan.back(), 499);
    }
  }
  // It may be two runs.
  std::string content = "#,F\n";
  for (int i = 0; i < 512; ++i) content += fmt::format("{},1\n", i % 256);
  const auto imported = import(content);
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_EQ(test::in_memory(imported->tests[0]).scan.back(), 511);
  EXPECT_THAT(imported->report, HasSubstr("starts again after 255, 1 time, as a counter of 8 bits does"));
  // Beside a coarse clock, too.
  std::string beside = "#,Time,F\n";
  for (int i = 0; i < 600; ++i) beside += fmt::format("{},12:00:0{},1\n", i % 256, i / 100);
  const auto clocked = import(beside);
  ASSERT_TRUE(clocked) << clocked.error().message;
  EXPECT_THAT(clocked->report, HasSubstr("starts again after 255, 2 times"));
  // Something else by the same name.
  expect_values("Points,F\n7,1\n7,2\n7,3\n", {1.0, 2.0, 3.0});
  EXPECT_THAT(report_, HasSubstr("does not count the rows"));
}

TEST_F(TraceImport, WithoutTimesTheRateIsNeeded) {
  expect_refused("F\n1\n2\n", "--rate HZ");
  // A column for times in which nothing stands.
  request_.rate_Hz = 100.0;
  expect_values("X_Value\tF\n\t1.5\n\t2.5\n", {1.5, 2.5});
}

// The command that is printed reads the file as it was inspected.
TEST_F(TraceImport, PrintedCommandKeepsWhatWasStated) {
  test::write_content(request_.path, "1;2\nt (s);F (N)\n0,00;1,5\n0,01;2,5\n0,02;3,5\n");
  request_.column.clear();
  request_.dialect = {Encoding::kWindows1252, ';', ',', 1};
  const std::string stated = " --encoding Windows-1252 --separator semicolon --decimal comma --skip 1 -o ";
  const auto text = inspect(request_);
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text, HasSubstr(stated));
  const auto imported = import_trace(request_);
  ASSERT_FALSE(imported);
  EXPECT_THAT(imported.error().message, HasSubstr(stated));
}

TEST_F(TraceImport, PrintedCommandImports) {
  for (const auto& [content, words] :
       {std::pair{"t (s),F (N),F (N)\n0.00,1,5\n0.01,2,5\n0.02,3,5\n", " --column 2 --sled-mass"},
        std::pair{"t (s),\x1b[31mF (N)\n0.00,1\n0.01,2\n0.02,3\n", " --column 2 --sled-mass"},
        std::pair{"t (s),F (g)\n0.00,1\n0.01,2\n0.02,3\n", " --column 'F (g)' --unit gf --sled-mass"},
        std::pair{"t (s),v0,v1\n0.00,1,0\n0.01,2,0\n0.02,3,0\n", " --column v0 --unit UNIT"}}) {
    test::write_content(request_.path, content);
    const auto text = inspect(request_);
    ASSERT_TRUE(text) << text.error().message;
    EXPECT_THAT(*text, HasSubstr(words));
  }
  // The unit tells columns of one name apart.
  request_.column = "F (N)";
  request_.unit.clear();
  EXPECT_TRUE(import("t,F,F\n(s),(kN),(N)\n0.00,1,1000\n0.01,2,2000\n0.02,3,3000\n"));
}

TEST_F(TraceImport, PrintedCommandNamesTheRecordAfterTheFile) {
  for (const auto& [file, record] :
       {std::pair{"a.b/nodot", "a.b/nodot.h5"}, std::pair{"a.b/x.csv", "a.b/x.h5"},
        std::pair{"a.b/x.h5", "a.b/x-record.h5"}, std::pair{"a.b/.csv", "a.b/.csv.h5"}}) {
    request_.path = folder_ / file;
    std::filesystem::create_directories(std::filesystem::path{request_.path}.parent_path());
    test::write_content(request_.path, "t (s),F (N)\n0.00,1\n0.01,2\n0.02,3\n");
    const auto text = inspect(request_);
    ASSERT_TRUE(text) << text.error().message;
    EXPECT_THAT(*text, HasSubstr(" -o " + (folder_ / record).string() + "\n"));
  }
}

TEST_F(TraceImport, MissingFileIsAUsageError) {
  const auto imported = import_trace(request_);
  ASSERT_FALSE(imported);
  EXPECT_EQ(imported.error().exit_status(), 2);
}

}  // namespace
}  // namespace stickslip::traces
