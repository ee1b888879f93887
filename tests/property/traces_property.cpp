// A table that was written in any layout is read back to the same values, or is refused: never other values.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "io/traces/import.hpp"

#include "tests/support/record_samples.hpp"

namespace stickslip::traces {
namespace {

/// How a table is written.
struct Layout {
  char separator = ',';
  char decimal = '.';
  Encoding encoding = Encoding::kUtf8;
  std::string line_end = "\n";
  bool quotes = false;
  bool unit = false;          ///< In the heading.
  bool milliseconds = false;  ///< Times are whole ms.
  int preamble = 0;           ///< Lines.
  bool thousands = false;     ///< Marked in the values.
  double rate_Hz = 100.0;
  int decimals = 4;  ///< Of the values.
};

Layout any_layout() {
  Layout layout;
  layout.separator = *rc::gen::element(',', ';', '\t', kBlanks);
  layout.decimal = *rc::gen::element('.', ',');
  layout.encoding = *rc::gen::element(Encoding::kUtf8, Encoding::kUtf16LittleEndian,
                                      Encoding::kUtf16BigEndian, Encoding::kWindows1252);
  layout.line_end = *rc::gen::element<std::string>("\n", "\r\n", "\r");
  layout.quotes = layout.separator != kBlanks && *rc::gen::arbitrary<bool>();
  if (layout.separator == layout.decimal) layout.quotes = true;
  layout.unit = *rc::gen::arbitrary<bool>();
  layout.preamble = *rc::gen::inRange(0, 12);
  layout.thousands = layout.separator != kBlanks && *rc::gen::arbitrary<bool>();
  layout.milliseconds = *rc::gen::arbitrary<bool>();
  layout.rate_Hz = *rc::gen::element(50.0, 100.0, 250.0, 1000.0);
  layout.decimals = *rc::gen::inRange(0, 6);
  return layout;
}

std::string number(const Layout& layout, double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  const std::size_t whole = std::min(text.find('.'), text.size());
  std::replace(text.begin(), text.end(), '.', layout.decimal);
  const char mark = layout.decimal == '.' ? ',' : '.';
  if (layout.thousands && (layout.quotes || mark != layout.separator)) {
    for (std::size_t at = whole; at > 3; at -= 3) text.insert(at - 3, 1, mark);
  }
  return layout.quotes ? "\"" + text + "\"" : text;
}

/// ASCII and the letter µ.
std::string encoded(const std::string& text, Encoding encoding) {
  if (encoding == Encoding::kUtf8) return text;
  std::string result;
  if (encoding == Encoding::kUtf16LittleEndian) result = "\xFF\xFE";
  if (encoding == Encoding::kUtf16BigEndian) result = "\xFE\xFF";
  for (const char c : text) {
    if (c == '\xC2') continue;  // Of µ, C2 B5 in UTF-8 and B5 in the others.
    if (encoding == Encoding::kUtf16BigEndian) result += '\0';
    result += c;
    if (encoding == Encoding::kUtf16LittleEndian) result += '\0';
  }
  return result;
}

struct Row {
  std::int64_t scan = 0;
  double value = 0.0;
};

/// Positive values: a force that is negative while sliding is refused.
std::vector<Row> any_rows(const Layout& layout) {
  std::vector<Row> rows;
  const auto count = *rc::gen::inRange<std::int64_t>(20, 300);
  const auto lost = *rc::gen::inRange<std::int64_t>(1, 2 * count);
  const double power = std::pow(10.0, layout.decimals);
  for (std::int64_t scan = 0; scan < count; ++scan) {
    if (scan >= lost && scan < lost + 5 && scan + 1 < count) continue;
    rows.push_back({scan, static_cast<double>(*rc::gen::inRange<std::int64_t>(0, 3'000'000)) / power});
  }
  return rows;
}

std::string written(const Layout& layout, const std::vector<Row>& rows) {
  std::string text;
  for (int i = 0; i < layout.preamble; ++i)
    text += fmt::format("Key {}{}{}{}", i, layout.separator,
                        *rc::gen::element<std::string>("abc", "12", "1,5", "0.25", "2024-01-02", "µ"),
                        layout.line_end);
  text += fmt::format("{}{}{}{}", layout.unit ? (layout.milliseconds ? "Time_ms" : "Time_s") : "Time",
                      layout.separator, layout.unit ? "Force_N" : "Force", layout.line_end);
  for (const Row& row : rows) {
    const double time_s = static_cast<double>(row.scan) / layout.rate_Hz;
    text += layout.milliseconds ? number(layout, 1e3 * time_s, 0) : number(layout, time_s, 6);
    text += layout.separator;
    text += number(layout, row.value, layout.decimals) + layout.line_end;
  }
  return encoded(text, layout.encoding);
}

RC_GTEST_PROP(TracesProperty, ATableIsReadBackOrRefused, ()) {
  const Layout layout = any_layout();
  const std::vector<Row> rows = any_rows(layout);
  const test::TemporaryFolder folder;
  ImportRequest request;
  request.path = folder / "trace.csv";
  test::write_content(request.path, written(layout, rows));
  request.column = "Force";
  request.unit = "N";
  request.time_unit = layout.milliseconds ? "ms" : "s";
  request.tester.sled_mass_kg = 0.2;
  const auto imported = import_trace(request);
  RC_CLASSIFY(imported.has_value(), "read");
  if (!imported) {
    RC_LOG() << imported.error().message;
    RC_ASSERT(imported.error().exit_status() == 2);
    RC_ASSERT(imported.error().message.find('\n') == std::string::npos);
    // Only a file that says too little is refused.
    RC_ASSERT(imported.error().message.find("has two readings") != std::string::npos);
    return;
  }
  std::vector<Row> read;
  for (const ImportedTest& test : imported->tests) {
    RC_ASSERT(std::abs(test.record.header.board.scan_rate_granted_Hz / layout.rate_Hz - 1.0) < 1e-4);
    test.scans.for_each_piece([&read](const record::ScanPiece& piece) {
      for (std::size_t i = 0; i < piece.scan.size(); ++i) read.push_back({piece.scan[i], piece.raw[i]});
    });
  }
  RC_ASSERT(read.size() == rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    RC_ASSERT(read[i].scan == rows[i].scan);
    RC_ASSERT(std::abs(read[i].value - rows[i].value) <= 1e-12 * rows[i].value);
  }
}

}  // namespace
}  // namespace stickslip::traces
