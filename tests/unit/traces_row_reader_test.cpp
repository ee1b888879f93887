#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "io/traces/row_reader.hpp"

namespace stickslip::traces {
namespace {

std::vector<std::string> fields_of(RowReader& reader, const std::string& line) {
  if (!reader.add(line)) return {};
  return {reader.fields().begin(), reader.fields().end()};
}

// A quoted field at the end sends the line through libcsv.
RC_GTEST_PROP(RowReaderProperty, SplitsALineWithoutQuotesAsLibcsvDoes, ()) {
  const char separator = *rc::gen::element(',', ';', '\t', '|', kBlanks);
  const auto words = *rc::gen::container<std::vector<std::string>>(
      rc::gen::element<std::string>(" ", "\t", ",", ";", "|", "1", "a", "->"));
  const std::string line = std::accumulate(words.begin(), words.end(), std::string{});
  RowReader fast{separator};
  RowReader by_libcsv{separator};
  std::vector<std::string> expected = fields_of(by_libcsv, line + std::string{separator} + "\"\"");
  RC_ASSERT(!expected.empty());
  expected.pop_back();
  if (expected.empty()) expected.emplace_back();  // A line of blanks.
  RC_ASSERT(fields_of(fast, line) == expected);
}

TEST(RowReader, GoesOnFromOneLineToTheNextWithinQuotes) {
  RowReader reader{','};
  EXPECT_FALSE(reader.add("1,\"two"));
  EXPECT_EQ(fields_of(reader, "lines, 2\",3"), (std::vector<std::string>{"1", "two\nlines, 2", "3"}));
  EXPECT_EQ(fields_of(reader, " 4 ,5"), (std::vector<std::string>{"4", "5"}));
  EXPECT_FALSE(reader.add(",\"two"));
  EXPECT_EQ(fields_of(reader, "lines\",3"), (std::vector<std::string>{"", "two\nlines", "3"}));
}

TEST(RowReader, AnArrowAloneIsABlankRow) {
  RowReader reader{kBlanks};
  EXPECT_EQ(fields_of(reader, "->"), (std::vector<std::string>{""}));
  EXPECT_EQ(fields_of(reader, "12:00:01 -> 0.34"), (std::vector<std::string>{"12:00:01", "0.34"}));
}

TEST(RowReader, TakesTheWholeLineWithoutASeparator) {
  RowReader reader{kNoSeparator};
  EXPECT_EQ(fields_of(reader, " 1,2;3 "), (std::vector<std::string>{"1,2;3"}));
}

}  // namespace
}  // namespace stickslip::traces
