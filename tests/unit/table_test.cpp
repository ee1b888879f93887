#include "io/table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

namespace stickslip::io {
namespace {

using enum Table::Align;

TEST(DisplayWidth, CountsPlacesOfATerminal) {
  EXPECT_EQ(display_width(""), 0U);
  EXPECT_EQ(display_width("S−K"), 3U);
  EXPECT_EQ(display_width("grün"), 4U);
  EXPECT_EQ(display_width("gru\u0308n"), 4U) << "a letter and a combining mark";
  EXPECT_EQ(display_width("紙 42"), 5U) << "a wide character";
  EXPECT_EQ(display_width("a\xff"), 2U) << "no UTF-8";
  EXPECT_EQ(display_width("\033[32mgood\033[0m"), 4U) << "colour codes";
}

TEST(Table, PadsByDisplayWidth) {
  Table table{{{.heading = "paper", .align = kLeft}, {.heading = "S", .format = ".4f"}}};
  table.add({"紙", 0.5});
  table.add({"gru\u0308n", 0.25});
  table.add({"linerboard", -1.0});
  EXPECT_EQ(table.text(),
            "paper             S\n"
            "紙           0.5000\n"
            "gru\u0308n         0.2500\n"
            "linerboard  -1.0000\n");
}

TEST(Table, GivesTheSameRowsAsTextCsvAndJson) {
  Table table{{{.name = "file", .heading = "file", .align = kLeft},
               {.name = "mu_s", .heading = "S", .format = ".2f"},
               {.name = "pull_speed", .heading = "speed", .unit = "mm/s"},
               {.name = "tests", .heading = "tests", .unit = "1"},
               {.name = "of_data_alone"},
               {.heading = "of text alone", .align = kLeft}}};
  table.add({"a.h5", 0.123, 5.0, 3, "x", "y"});
  EXPECT_EQ(table.text(),
            "file     S  speed (mm/s)  tests  of text alone\n"
            "a.h5  0.12             5      3  y\n");
  EXPECT_EQ(table.csv(), "file,mu_s,pull_speed,tests,of_data_alone\r\na.h5,0.123,5,3,x\r\n");
  EXPECT_EQ(table.json().dump(),
            R"([{"file":"a.h5","mu_s":0.123,"pull_speed":5.0,"tests":3,"of_data_alone":"x"}])");
}

TEST(Table, HasADashABlankAnEmptyCellAndNullForNothing) {
  Table table{{{.name = "n", .heading = "n"},
               {.name = "why", .heading = "why", .align = kLeft},
               {.name = "last", .heading = "last"}}};
  table.add({{}, {}, std::nan("")});
  table.add({std::numeric_limits<double>::infinity()});  // Ends with its last cell.
  table.add({cell(std::optional<double>{}), "because"});
  EXPECT_EQ(table.text(),
            "n  why  last\n"
            "–          –\n"
            "–\n"
            "–  because\n");
  EXPECT_EQ(table.csv(), "n,why,last\r\n,,\r\n,,\r\n,because,\r\n");
  EXPECT_EQ(table.json().dump(), R"([{"n":null,"why":null,"last":null},{"n":null,"why":null,"last":null},)"
                                 R"({"n":null,"why":"because","last":null}])");
}

TEST(Table, WithoutRowsHasItsHeadings) {
  const Table table{{{.name = "file", .heading = "file", .width = 6}}};
  EXPECT_EQ(table.text(), "  file\n");
  EXPECT_EQ(table.csv(), "file\r\n");
  EXPECT_EQ(table.json().dump(), "[]");
}

TEST(Table, HasNoLineOfBlankHeadings) {
  Table table{{{.heading = ""}, {.heading = "", .align = kLeft}}};
  table.add({"0.5", "S S r"});
  table.add({"12", ""});
  EXPECT_EQ(table.text(), "0.5  S S r\n 12\n");
}

TEST(Table, LastCellOfARowRunsOverTheColumnsBehindItIfLeftAligned) {
  Table table{{{.heading = "kept", .align = kLeft}, {.heading = "S"}}};
  table.add({"spikes", 0.25});
  table.add({"no drift to take off"});
  EXPECT_EQ(table.text(),
            "kept       S\n"
            "spikes  0.25\n"
            "no drift to take off\n");
}

TEST(Table, ListHasLeftAlignedColumnsWithoutHeadings) {
  Table list = Table::list({4, 0, 0});
  EXPECT_EQ(list.text(), "");
  list.add({"bad", "disk", "full"});
  list.add({"", "", "→ delete"});
  list.add({"good", "filesystem"});
  EXPECT_EQ(list.text(),
            "bad   disk  full\n"
            "            → delete\n"
            "good  filesystem\n");
}

TEST(Table, PadsColouredCellsAndKeepsOtherControlCharactersOut) {
  Table list = Table::list({0, 0});
  list.add({"\033[31mbad\033[0m", "a\n\033[2J"});
  list.add({"good", "b"});
  EXPECT_EQ(list.text(true), "\033[31mbad\033[0m   a\\x0a\\x1b[2J\ngood  b\n");
  EXPECT_EQ(list.text().find('\033'), std::string::npos);
}

// A spreadsheet would run the formula; numbers are none.
TEST(Table, CsvQuotesTextsAndDisarmsFormulas) {
  Table table{{{.name = "text"}, {.name = "number"}}};
  table.add({"=1+1", -1.5});
  table.add({"a \"b\", c", 1e-300});
  EXPECT_EQ(table.csv(), "text,number\r\n'=1+1,-1.5\r\n\"a \"\"b\"\", c\",1e-300\r\n");
}

}  // namespace
}  // namespace stickslip::io
