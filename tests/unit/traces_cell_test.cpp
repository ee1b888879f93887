// One cell: the same characters are a number in one language and text in another.

#include <gtest/gtest.h>

#include <cmath>

#include "io/traces/cell.hpp"
#include "io/traces/column_name.hpp"
#include "io/traces/quantity_unit.hpp"
#include "io/traces/trace_time.hpp"

namespace stickslip::traces {
namespace {

double number(std::string_view text, char decimal = '.') {
  const Cell cell = read_cell(text, decimal);
  return cell.kind == CellKind::kNumber ? cell.value : std::nan("");
}

CellKind kind(std::string_view text, char decimal = '.') { return read_cell(text, decimal).kind; }

double seconds(std::string_view text, char decimal = '.') {
  const auto time = read_time_cell(text, decimal);
  return time ? time->value : std::nan("");
}

TEST(TraceCell, NumbersHaveSignsExponentsAndBothDecimalMarks) {
  EXPECT_EQ(number(" +3 "), 3.0);
  EXPECT_EQ(number("-1e-3"), -0.001);
  EXPECT_EQ(number("\xE2\x88\x92"
                   "0.5"),
            -0.5);
  EXPECT_EQ(number("1,234E+01", ','), 12.34);
  EXPECT_EQ(number(".5"), 0.5);
  EXPECT_EQ(number("-1.5D+02"), -150.0);
  EXPECT_EQ(number("1.0d-01"), 0.1);
  EXPECT_EQ(kind("12D4"), CellKind::kText);
}

TEST(TraceCell, ThousandsAreMarkedAsEachLanguageMarksThem) {
  EXPECT_EQ(number("1,234,567.5"), 1234567.5);
  EXPECT_EQ(number("-1.234,56", ','), -1234.56);
  EXPECT_EQ(number("1 234,5", ','), 1234.5);
  EXPECT_EQ(number("1\xC2\xA0"
                   "234,5",
                   ','),
            1234.5);
  EXPECT_EQ(number("12\xE2\x80\xAF"
                   "345,5",
                   ','),
            12345.5);
  EXPECT_EQ(number("1'234.5"), 1234.5);
}

TEST(TraceCell, GroupsThatAreNotOfThreeDigitsAreNoThousands) {
  for (const std::string_view text :
       {"1,23", "1,2345", "0,005", "1,234,56", "1,234 567", "1,234.567.8", "12 34"})
    EXPECT_EQ(kind(text), CellKind::kText) << text;
}

TEST(TraceCell, MissingValuesAreHoles) {
  for (const std::string_view text :
       {"NaN", "-nan", "#N/A", "#DIV/0!", "#WERT!", "-1.#IND", "OVLD", "+OL", "---", "******", "Infinity",
        "overrange", "\xE2\x88\x9E", "-\xE2\x88\x9E", "9.9E37", "+9.91000000E+37", "-9.900E+37"})
    EXPECT_EQ(kind(text), CellKind::kHole) << text;
  EXPECT_EQ(kind(" "), CellKind::kEmpty);
  EXPECT_EQ(kind("9.92e37"), CellKind::kNumber);
}

TEST(TraceCell, UnitStandsBehindANumber) {
  EXPECT_EQ(read_cell("0.5 N", '.').unit, "N");
  EXPECT_EQ(kind(std::string_view{"0.5\0\0", 5}), CellKind::kText);
  EXPECT_EQ(kind("0.5-"), CellKind::kText);
  EXPECT_EQ(kind("1e999"), CellKind::kText);
  EXPECT_EQ(kind("2024-01-02"), CellKind::kText);
}

TEST(TraceCell, ClocksHaveTwelveOrTwentyFourHours) {
  EXPECT_EQ(seconds("00:01:02.5"), 62.5);
  EXPECT_EQ(seconds("01:02,5"), 62.5);
  EXPECT_EQ(seconds("12:00:01 AM"), 1.0);
  EXPECT_EQ(seconds("12:00:01 PM"), 43201.0);
  EXPECT_EQ(seconds("1:00:00 pm"), 46800.0);
  EXPECT_TRUE(std::isnan(seconds("13:00:00 PM")));
  EXPECT_TRUE(std::isnan(seconds("0:00:00 AM")));
}

TEST(TraceCell, DatesWithPointsHaveTheDayFirstAndSlashesTellNoDate) {
  const auto iso = read_time_cell("2024-02-01T12:00:00Z", '.');
  const auto german = read_time_cell("01.02.2024 12:00:00,000", ',');
  ASSERT_TRUE(iso && german);
  EXPECT_EQ(iso->date_s, german->date_s);
  const auto slashes = read_time_cell("1/2/2024 12:00:00", '.');
  ASSERT_TRUE(slashes);
  EXPECT_FALSE(slashes->date_s);
  EXPECT_EQ(slashes->value, 43200.0);
  EXPECT_FALSE(read_time_cell("30.02.2024 12:00:00", '.'));
  for (const char* const text : {"01-Feb-2024 12:00:00", "1 FEB 2024 12:00:00", "Feb 1, 2024 12:00:00 PM",
                                 "February 1 2024 12:00:00:000", "2024-Feb-01 12:00:00"}) {
    const auto words = read_time_cell(text, '.');
    ASSERT_TRUE(words) << text;
    EXPECT_EQ(words->date_s, iso->date_s) << text;
    EXPECT_EQ(words->value, iso->value) << text;
  }
  for (const char* const text : {"1/2/24 12:00:00", "24-02-01 12:00:00", "01.02.24 12:00:00"}) {
    const auto unclear = read_time_cell(text, '.');
    ASSERT_TRUE(unclear) << text;
    EXPECT_FALSE(unclear->date_s) << text;
    EXPECT_EQ(unclear->value, 43200.0) << text;
    EXPECT_EQ(unclear->unclear_date, std::string_view{text}.substr(0, unclear->unclear_date.size())) << text;
    EXPECT_FALSE(unclear->unclear_date.empty()) << text;
  }
  // Hours are padded with a blank.
  for (const char* const text : {"2024-02-01  9:00:00", "01.02.2024  9:00:00", "2024-02-01T 9:00:00"}) {
    const auto padded = read_time_cell(text, '.');
    ASSERT_TRUE(padded) << text;
    EXPECT_EQ(padded->date_s, iso->date_s) << text;
    EXPECT_EQ(padded->value, 32400.0) << text;
  }
  EXPECT_EQ(seconds("1/2/2024  1:00:00 PM"), 46800.0);
  EXPECT_EQ(seconds("1/0/1900 0:00:01"), 1.0);  // Of a clock that was never set.
  EXPECT_EQ(seconds("12:00:00:500"), 43200.5);
  EXPECT_EQ(read_time_cell("12:00:00:500", '.')->decimals, 3);
  for (const char* const text :
       {"12:00:00:50", "99-99-99 12:00:00", "2024-268-25 12:00:00", "2024-11-257 12:00:00"})
    EXPECT_FALSE(read_time_cell(text, '.')) << text;
  for (const char* const text :
       {"31-Feb-2024 12:00:00", "01-Fog-2024 12:00:00", "12 Feb 2024", "12:00:00:1x3"})
    EXPECT_FALSE(read_time_cell(text, '.')) << text;
}

TEST(TraceColumnName, UnitIsInBracketsBehindAWordOrBelow) {
  for (const std::string_view heading :
       {"Force (N)", "Force [N]", "Force_N", "Force in N", "Force, N", "Force/N"}) {
    const ColumnName column = column_name(heading);
    EXPECT_EQ(column.unit, "N") << heading;
    EXPECT_EQ(column.name, "Force") << heading;
  }
  EXPECT_EQ(column_name("Force", "[N]").unit, "N");
  EXPECT_EQ(column_name("Force (N) Run #1").name, "Force Run #1");
  EXPECT_EQ(column_name("x_y").unit, "");
  EXPECT_TRUE(is_unit("Sec"));
  EXPECT_FALSE(is_unit("n"));
}

TEST(TraceColumnName, FormsOfTheSameCharactersAreEqual) {
  EXPECT_EQ(folded("Pru\xCC\x88"
                   "fkraft"),
            folded("PR\xC3\x9C"
                   "FKRAFT"));
  EXPECT_EQ(folded("\xC2\xB5"), folded("\xCE\xBC"));
}

TEST(TraceColumnName, SomeNamesAreTimes) {
  for (const std::string_view name : {"Time (s)", "Zeit", "Prüfzeit", "Latest: Time (s)", "Temps", "X_Value"})
    EXPECT_EQ(time_rank(column_name(name)), 2) << name;
  EXPECT_EQ(time_rank(column_name("t (s)")), 1);
  for (const std::string_view name : {"Force", "Temperature", "Timer"})
    EXPECT_EQ(time_rank(column_name(name)), 0) << name;
}

TEST(TraceQuantityUnit, UnknownUnitsAreRefusedWithTheKnownOnes) {
  EXPECT_EQ(quantity_unit("cN")->scale, 0.01);
  EXPECT_EQ(quantity_unit("%")->scale, 0.01);
  ASSERT_FALSE(quantity_unit("g"));
  EXPECT_NE(quantity_unit("g").error().message.find("is in gf"), std::string::npos);
}

}  // namespace
}  // namespace stickslip::traces
