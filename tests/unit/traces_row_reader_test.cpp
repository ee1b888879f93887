#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

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
  const auto line = *rc::gen::container<std::string>(rc::gen::element(' ', '\t', ',', ';', '|', '1', 'a'));
  RowReader fast{separator};
  RowReader by_libcsv{separator};
  std::vector<std::string> expected = fields_of(by_libcsv, line + std::string{separator} + "\"\"");
  RC_ASSERT(!expected.empty());
  expected.pop_back();
  const std::vector<std::string> fields = fields_of(fast, line);
  const bool is_blank = expected.empty() || (expected.size() == 1 && expected.front().empty());
  RC_ASSERT(fields == (is_blank ? std::vector<std::string>{} : expected));
}

TEST(RowReader, GoesOnFromOneLineToTheNextWithinQuotes) {
  RowReader reader{','};
  EXPECT_FALSE(reader.add("1,\"two"));
  EXPECT_EQ(fields_of(reader, "lines, 2\",3"), (std::vector<std::string>{"1", "two\nlines, 2", "3"}));
  EXPECT_EQ(fields_of(reader, " 4 ,5"), (std::vector<std::string>{"4", "5"}));
}

TEST(RowReader, TakesTheWholeLineWithoutASeparator) {
  RowReader reader{kNoSeparator};
  EXPECT_EQ(fields_of(reader, " 1,2;3 "), (std::vector<std::string>{"1,2;3"}));
}

}  // namespace
}  // namespace stickslip::traces
