// What somebody else wrote can do nothing to a terminal, a table or a page.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/json_text.hpp"
#include "io/table.hpp"
#include "report/report_page.hpp"
#include "report/truth_table.hpp"

#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "daemon/app/log.hpp"
#include "daemon/types/reply.hpp"
#include "tests/support/hostile_text.hpp"

namespace stickslip::report {
namespace {

using test::expect_safe;
using test::hostile;
using test::lines_of;

class CollectedLines final : public app::LogOutput {
 public:
  explicit CollectedLines(std::vector<std::string>& lines) : lines_(lines) {}
  void write(const app::LogEntry& entry) override { lines_.push_back(entry.message); }

 private:
  std::vector<std::string>& lines_;
};

RC_GTEST_PROP(TextProperty, ATextIsOneSafeLine, ()) {
  const std::string text = *hostile();
  const std::string shown = base::printable(text);
  expect_safe(shown);
  RC_ASSERT(lines_of(shown) == 0);
  RC_ASSERT(base::printable(shown) == shown);
  expect_safe(base::one_line(text));
}

RC_GTEST_PROP(TextProperty, WhatIsTakenAsANameIsShownAsItIs, ()) {
  const std::string text = *hostile();
  const std::string why = base::name_refusal(text);
  expect_safe(why);
  RC_ASSERT(why.empty() ==
            (text.size() <= base::kLongestName && base::is_utf8(text) && base::printable(text) == text));
}

RC_GTEST_PROP(TextProperty, ACellIsNoFormulaAndReadsBack, ()) {
  const std::string text = *hostile();
  const std::string cell = base::csv_cell(text);
  expect_safe(cell);
  RC_ASSERT(!cell.starts_with('#'));
  std::string read = cell;
  if (cell.starts_with('"')) {
    RC_ASSERT(cell.size() >= 2 && cell.ends_with('"'));
    read.clear();
    for (std::size_t i = 1; i + 1 < cell.size(); ++i) {
      if (cell[i] == '"') RC_ASSERT(cell[++i] == '"');
      read += cell[i];
    }
  } else {
    RC_ASSERT(cell.find_first_of(",;\"") == cell.npos);
  }
  RC_ASSERT((read.empty() || std::string_view{"=+-@"}.find(read.front()) == std::string_view::npos));
  const std::string shown = base::printable(text);
  RC_ASSERT((read == shown || read == "'" + shown));
}

RC_GTEST_PROP(TextProperty, TheTableHasItsLinesWhateverTheFileIsCalled, ()) {
  const std::string hostile_name = *hostile();
  // As wide: a name that is too long for its column stands below the table.
  TableRow plain{1, {}, std::nullopt, std::string(io::display_width(base::printable(hostile_name)), 'a')};
  TableRow named = plain;
  named.where = hostile_name;
  named.results.findings = {{.code = *hostile(), .text = *hostile(), .action = *hostile()}};
  plain.results.findings = {{.code = "x", .text = "x", .action = "x"}};
  const std::string text = format_table(std::array{named});
  expect_safe(text);
  RC_ASSERT(lines_of(text) == lines_of(format_table(std::array{plain})));
}

RC_GTEST_PROP(TextProperty, ALogEntryIsOneSafeLine, ()) {
  std::vector<std::string> lines;
  app::make_log(io::LogLevel::kInfo, std::make_unique<CollectedLines>(lines))
      ->orphan_kept(*hostile(), *hostile());
  RC_ASSERT(lines.size() == 1U);
  expect_safe(lines.front());
  RC_ASSERT(lines_of(lines.front()) == 0);
}

RC_GTEST_PROP(TextProperty, JsonStaysTheSameAndEndsNoScript, ()) {
  const std::string text = *hostile();
  const nlohmann::ordered_json json{{"name", text}};
  const std::string answer = io::json_text(json);
  expect_safe(answer);
  const std::string replaced = json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  RC_ASSERT(nlohmann::ordered_json::parse(answer) == nlohmann::ordered_json::parse(replaced));
  expect_safe(json_for_script(json));
  RC_ASSERT(json_for_script(json).find('<') == std::string::npos);
}

TEST(Text, OrdinaryTextOfAnyLanguageStays) {
  for (const char* text :
       {"Thorold 42 g/m²", "γ/2ω – S−K", "紙 の 摩擦", "نامه‌ای", "👩‍🔬", "C:\\records"}) {
    EXPECT_EQ(base::printable(text), text);
    EXPECT_EQ(base::name_refusal(text), "");
  }
}

}  // namespace
}  // namespace stickslip::report
