// The layout of the table is recognised, or both readings are shown.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "tests/unit/traces_sample.hpp"

namespace stickslip::traces {
namespace {

class TraceDialect : public Traces {
 protected:
  TraceDialect() { request_.rate_Hz = 100.0; }
};

TEST_F(TraceDialect, ReadsWhatSpreadsheetsWrite) {
  expect_values("\xEF\xBB\xBF\"t\",\"F\",\"note, long\"\r\n0,0.5,\"a \"\"b\"\"\nsecond line\"\r\n0.01,1,\r\n",
                {0.5, 1.0});
  expect_values("sep=;\nt;F\n0;0,25\n0,01;0,5\n", {0.25, 0.5});
  expect_values("\"t\",\"F\"\n\"0,00\",\"0,25\"\n\"0,01\",\"0,5\"\n", {0.25, 0.5});
  expect_values("t\tF\n0.00\t1,000.5\n0.01\t1,001.5\n", {1000.5, 1001.5});
  expect_values("t;F\n0,00;1 000,5\n0,01;1 001,5\n", {1000.5, 1001.5});
}

TEST_F(TraceDialect, ReadsEveryEncodingAndLineEnd) {
  const std::string wide = "t\tF\n0.00\t1\n0.01\t2\n";
  std::string utf16;
  for (const char c : wide) utf16 += {c, '\0'};
  expect_values(utf16, {1.0, 2.0});
  expect_values("t;F;\xB5\n0;1;1\n0,01;2;1\n", {1.0, 2.0});
  expect_values("t,F\r0.00,1\r0.01,2\r", {1.0, 2.0});
  expect_values("t,F\r\n0.00,1\n0.01,2", {1.0, 2.0});
}

TEST_F(TraceDialect, PreambleUnitsAndShortTablesStandBeforeTheScans) {
  std::string results = ",\"Peak\"\n,\"(N)\"\n1,8.7\n2,8.6\n\nt,F\n(s),(1)\n";
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) {
    results += fmt::format("{:.2f},{}\n", 0.01 * i, i);
    values.push_back(i);
  }
  expect_values(results, values);
  std::string preamble = "Operator: x, 2024\n";
  for (int i = 0; i < 20; ++i) preamble += fmt::format("Key {},{}\n", i, 2 * i);
  expect_values(preamble + results.substr(results.find("t,F")), values);
}

// A number that was destroyed near the beginning is no preamble.
TEST_F(TraceDialect, BadRowNearTheBeginningIsRefused) {
  std::string content = "t,F\n0.00,1\n0.01,1\n0.02,x\n";
  for (int i = 3; i < 60; ++i) content += fmt::format("{:.2f},{}\n", 0.01 * i, i);
  expect_refused(content, ":4: column 'F' is 'x'");
}

TEST_F(TraceDialect, SeparatorsAtTheEndAreNoColumns) {
  expect_values("t,F\n0.00,1,\n0.01,2,\n", {1.0, 2.0});
  expect_values("t\tF\n0,00\t0,5\t\n0,01\t0,6\t\n", {0.5, 0.6});
}

TEST_F(TraceDialect, CommentsMayStandBehindRows) {
  expect_values("X_Value\tF\tComment\n0.00\t1\tbegin\n0.01\t2\n0.02\t3\n", {1.0, 2.0, 3.0});
}

TEST_F(TraceDialect, NamesBetweenBlanksBelongToTheirColumns) {
  expect_values("  t (s)    F (1)\n 0.00   1\n 0.01   2\n", {1.0, 2.0});
  expect_values("# t F\n0.00 1\n0.01 2\n", {1.0, 2.0});
  // Names of two words have wider blanks between them.
  expect_values("t (s)   Peak Speed   F (1)\n0.00   5   1\n0.01   5   2\n", {1.0, 2.0});
  expect_values("t (s)\tPeak Speed\tF\n0.00 5 1\n0.01 5 2\n", {1.0, 2.0});
  // Else a name of two words would shift the names behind it.
  expect_refused(
      "t Peak F\n0.00 1\n0.01 2\n",
      ":1: the names of the 2 columns have blanks in them and cannot be told apart, so there is no column "
      "\"F\": give the number, 1 … 2");
  request_.column = "2";
  request_.time_column = "1";
  request_.time_unit = "s";
  expect_values("t Peak F\n0.00 1\n0.01 2\n", {1.0, 2.0});
}

TEST_F(TraceDialect, HeadingMayHaveFewerNamesThanColumns) {
  // R's write.table, with quotes and without.
  expect_values("\"Time\" \"F\"\n\"1\" 0.00 1.5\n\"2\" 0.01 2.5\n", {1.5, 2.5});
  expect_values("Time F Pos\n1 0.00 1.5 0.1\n2 0.01 2.5 0.2\n", {1.5, 2.5});
  expect_values("Time\tF\n1\t0.00\t1.5\n2\t0.01\t2.5\n", {1.5, 2.5});
  // A column that begins later.
  expect_values("t (s),F\n0.00,1.5\n0.01,2.5\n0.02,3.5,7\n0.03,4.5,8\n0.04,5.5,9\n",
                {1.5, 2.5, 3.5, 4.5, 5.5});
}

TEST_F(TraceDialect, NamesMayBeDigitsBesideATime) {
  request_.column = "2";
  expect_values("Time (s),1,2\n0.00,5,1.5\n0.01,6,2.5\n", {1.5, 2.5});
}

TEST_F(TraceDialect, ScansMayBeginBelowRowsOfTime) {
  std::string content = "t (s),F\n0.00,warming up\n0.01,warming up\n";
  std::vector<double> values;
  for (int i = 2; i < 60; ++i) {
    content += fmt::format("{:.2f},{}\n", 0.01 * i, i);
    values.push_back(i);
  }
  expect_values(content, values);
  // Values with another decimal mark are no names.
  expect_refused("0,00;1,5\n0;2,5\n" + std::string{"0.02;3.5\n0.03;4.5\n0.04;5.5\n0.05;6.5\n0.06;7.5\n"},
                 "the file has no heading");
}

TEST_F(TraceDialect, RowsOfUnitsAndCommentsFollowTheNames) {
  request_.unit.clear();
  for (const std::string heading :
       {"\"TOA5\",\"CR1000\",\"x\",\"Std\"\n\"TIMESTAMP\",\"RECORD\",\"F\"\n\"TS\",\"RN\",\"N\"\n\"\",\"\","
        "\"Smp\"\n",
        "A(X),B(Y),C(Y)\nTime,Pos,F\ns,mm,N\nrun 12,run 12,run 12\n", "Time,Pos,F\ns,mm,N\n,run 12,run 12\n",
        "Zeit,Weg,F\ns,mm,N\nMX840A,WA/50mm,U2B/1kN\nBessel,Bessel,Bessel\n"}) {
    const auto imported = import(heading + "0.00,1,1.5\n0.01,2,2.5\n0.02,3,3.5\n");
    ASSERT_TRUE(imported) << heading << imported.error().message;
    EXPECT_EQ(test::in_memory(imported->tests.front()).raw, (std::vector{1.5, 2.5, 3.5}));
  }
  // A row with the name of a time is that of the names, whatever stands above it.
  request_.unit = "V";
  request_.load_cell = daq::LoadCell{2.0, 0.0};
  request_.column = "V";
  expect_values("Run,Run,Run\nt,F,V\n0.00,1,1.5\n0.01,2,2.5\n", {1.5, 2.5});
}

TEST_F(TraceDialect, BarsSeparateColumns) {
  expect_values("t|F\n0.00|1.5\n0.01|2.5\n", {1.5, 2.5});
  expect_values("t|F\n0,00|1,5\n0,01|2,5\n", {1.5, 2.5});
  expect_values("| t (s) | F |\n|---|---|\n| 0.00 | 1.5 |\n| 0.01 | 2.5 |\n", {1.5, 2.5});
  expect_values(" t    | F\n------+-----\n 0.00 | 1.5\n 0.01 | 2.5\n 0.02 | 3.5\n 0.03 | 4.5\n(4 rows)\n",
                {1.5, 2.5, 3.5, 4.5});
}

TEST_F(TraceDialect, VernierHasARowOfSymbolsBetweenNamesAndUnits) {
  request_.unit.clear();
  request_.column = "Force";
  const auto record = expect_values(
      "Vernier Format 2\nslide.txt 11/25/2026 12:00:00 .\nRun "
      "1\nTime\tAcceleration\tForce\nt\ta\tF\ns\tm/s²\tN\n\n"
      "0.00\t0.1\t1.5\n0.01\t0.2\t2.5\n0.02\t0.2\t3.5\n",
      {1.5, 2.5, 3.5});
  EXPECT_EQ(record.header.board.quantity, daq::RawQuantity::kForce_N);
}

TEST_F(TraceDialect, CommaMayBeSeparatorAndDecimalMark) {
  const std::string content = "Zeit (s),F\n0,000,0,0158\n0,005,-0,0376\n0,010,0,0151\n";
  expect_refused(content, ":2: \"0,000,0,0158\" has two readings: 4 columns, or 2 with decimal commas");
  request_.dialect.separator = ',';
  request_.column = "4";
  expect_values(content, {158.0, 376.0, 151.0});
  // A decimal point tells.
  request_.dialect.separator.reset();
  expect_values("Run,b\n0,1,0.5,20\n0,2,0.5,30\n", {20.0, 30.0});
}

// Of a file in which somebody replaced commas by points, but not all.
TEST_F(TraceDialect, TwoDecimalMarksInOneColumnAreRefused) {
  const std::string content = "t;F\n0.00;0.123\n0.01;0.250\n0.02;6,944\n0.03;0.5\n";
  expect_refused(
      content,
      ":4: column 'F' is '6,944', and '0.123' in line 2: 6944 or 6.944. Give --decimal \".\" if it is 6944");
  expect_refused("t;F\n0,00;0,123\n0,01;0,250\n0,02;6.944\n",
                 "6944 or 6.944. Give --decimal \",\" if it is 6944");
  request_.dialect.decimal = '.';
  expect_values(content, {0.123, 0.25, 6944.0, 0.5});
  request_.dialect.decimal.reset();
  // Marks of thousands beside the same decimals are clear.
  expect_values("t\tF\n0.00\t0.123\n0.01\t6,944.000\n", {0.123, 6944.0});
}

// The first half is no preamble.
TEST_F(TraceDialect, ADecimalMarkThatChangesIsRefused) {
  std::string content = "t;F\n";
  for (int i = 0; i < 40; ++i)
    content += fmt::format("1{0}{1:03};0{0}{2:04}\n", i < 20 ? ',' : '.', 10 * i, 7 * i);
  expect_refused(
      content,
      ":2: \"1,000 0,0000\" is a row with the decimal mark ',', and rows from line 22 on have '.': "
      "write one mark in the whole file, or give --skip 21");
  request_.dialect.skip = 21;
  request_.column = "2";
  ASSERT_TRUE(import(content));
}

TEST_F(TraceDialect, SkipReachesBeyondTheLinesThatAreLookedAt) {
  std::string content;
  for (int i = 0; i < 2500; ++i) content += "a line of a log\n";
  content += "t (s),F\n0.00,1\n0.01,2\n0.02,3\n";
  expect_refused(content, "no table of numbers is found in its first 2000 lines");
  request_.dialect.skip = 2500;
  expect_values(content, {1.0, 2.0, 3.0});
  request_.dialect.skip = 3000;
  expect_refused(content, "has 2504 lines, and --skip 3000 leaves none");
}

TEST_F(TraceDialect, InspectionShowsClockTimes) {
  test::write_content(request_.path, "Clock,F\n12:00:00.00,1\n12:00:00.01,2\n12:01:02.50,3\n");
  auto text = inspect(request_);
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text, testing::HasSubstr("12:00:00.00 … 12:01:02.50"));
  EXPECT_THAT(*text, testing::HasSubstr(" --time-column Clock "));
  test::write_content(request_.path, "Clock,F\n2026-11-25T12:00:00Z,1\n2026-11-25T12:00:01Z,2\n");
  text = inspect(request_);
  ASSERT_TRUE(text) << text.error().message;
  EXPECT_THAT(*text, testing::HasSubstr("2026-11-25T12:00:00"));
  EXPECT_THAT(*text, testing::HasSubstr("2026-11-25T12:00:01"));
}

TEST_F(TraceDialect, LabelsAndArrowsOfLoggersAreUnderstood) {
  expect_values("t:0.00,F:1\nt:0.01,F:2\n", {1.0, 2.0});
  request_.column = "2";
  request_.time_column = "1";
  expect_values("12:00:00.000 -> 0.5\n12:00:00.010 -> 0.6\n", {0.5, 0.6});
}

TEST_F(TraceDialect, MoreRowsDecideWhichMarkIsTheDecimalOne) {
  expect_values("t;F\n0.000;0.010\n0.010;0.500\n0.020;1.250\n0.030;1.500\n", {0.01, 0.5, 1.25, 1.5});
  expect_values("F\n0,104578\n0,003050\n0,012000\n", {0.104578, 0.00305, 0.012});
}

TEST_F(TraceDialect, TwoReadingsAreShownWithTheOptionsThatDecide) {
  const std::string content = "t;F\n1,000;1,250\n1,010;2,500\n";
  expect_refused(content, "has two readings");
  request_.dialect.decimal = ',';
  expect_values(content, {1.25, 2.5});
}

TEST_F(TraceDialect, TwoReadingsAreShownWhereTheyDiffer) {
  expect_refused("t;F\n0;16\n10;38\n1.000;41\n1.010;42\n",
                 ":4: \"1.000;41\" has two readings: 1 and 41 (--decimal \".\"), or 1000 and 41");
}

// A heading with commas tells the separator, not what "1.000" means.
TEST_F(TraceDialect, QuotedThousandsOrDecimalsAreTwoReadings) {
  expect_refused("Time,F\n\"0\",\"1.250\"\n\"10\",\"2.500\"\n", "has two readings: 0 and 1.25");
}

TEST_F(TraceDialect, RefusesWhatIsNoTable) {
  expect_refused("", "is empty");
  expect_refused("F\n", ":1: no table of numbers");
  expect_refused("Run\n<td>0.5</td>\n<td>0.6</td>\n",
                 ":2: no table of numbers is found in its first 3 lines; "
                 "this one cannot be read: \"<td>0.5</td>\"");
  expect_refused("a,b\n1,2\n2,3\n", ":1: there is no column \"F\"; there are 1 \"a\", 2 \"b\"");
  expect_refused("F,F\n1,2\n2,3\n", "columns 1 and 2 are both called \"F\"");
  expect_refused("PK\x03\x04", "Excel");
}

}  // namespace
}  // namespace stickslip::traces
