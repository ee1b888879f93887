#include "io/traces/column_name.hpp"

#include <utf8proc.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>

#include "io/traces/cell.hpp"

namespace stickslip::traces {
namespace {

/// What may stand in a row of units, or behind a name.
constexpr std::array<std::string_view, 44> kUnits{
    "N", "mN", "kN", "gf",   "kgf",    "g",      "kg",     "lbf", "ozf", "lb",      "cN",
    "V", "mV", "uV", "µV",   "s",      "sec",    "ms",     "us",  "µs",  "min",     "h",
    "m", "mm", "cm", "um",   "µm",     "in",     "inch",   "m/s", "Hz",  "%",       "1",
    "-", "°C", "C",  "mm/s", "mm/min", "in/min", "counts", "MPa", "kPa", "percent", "coefficient"};
/// In folded form.
constexpr std::array<std::string_view, 28> kTimes{
    "time",    "zeit",        "prüfzeit",   "testzeit", "messzeit", "timestamp", "millis",
    "micros",  "elapsed",     "x_value",    "temps",    "tempo",    "tiempo",    "datetime",
    "seconds", "sekunden",    "laufzeit",   "tid",      "aika",     "uhrzeit",   "runtime",
    "время",   "zeitstempel", "horodatage", "heure",    "hora",     "date/time", "zeitpunkt"};
/// Parts of a test, folded.
constexpr std::array<std::string_view, 5> kParts{"cycle", "step", "segment", "zyklus", "schritt"};
/// Units in folded form that are written as words in any case.
constexpr std::array<std::string_view, 24> kUnitWords{
    "msec", "usec",  "sec",  "secs",     "second", "seconds", "newton", "newtons",
    "gram", "grams", "volt", "volts",    "min",    "gf",      "kgf",    "lbf",
    "ozf",  "lbs",   "kp",   "sekunden", "hours",  "hr",      "hrs",    "stunden"};
/// What is counted, folded and in the singular: "Sample No.", "Points".
constexpr std::array<std::string_view, 17> kCounted{
    "scan",   "sample", "point", "data point", "datapoint", "datenpunkt", "messpunkt", "record", "reading",
    "packet", "zähler", "row",   "frame",      "seq",       "n",          "i",         "lfd"};
/// Words for a number, folded, alone or behind what is counted.
constexpr std::array<std::string_view, 14> kNumberWords{"#",      "no",     "no.",   "nr",     "nr.",
                                                        "n°",     "number", "num",   "index",  "idx",
                                                        "nummer", "numéro", "count", "counter"};

template <typename Words>
bool has(const Words& words, std::string_view text) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

std::string_view without_brackets(std::string_view text) {
  text = trimmed(text);
  if (text.size() >= 2 &&
      ((text.front() == '(' && text.back() == ')') || (text.front() == '[' && text.back() == ']')))
    text = trimmed(text.substr(1, text.size() - 2));
  return text;
}

std::string one_blank(std::string_view text) {
  std::string result;
  for (const char c : trimmed(text)) {
    const char plain = c == '\n' || c == '\r' || c == '\t' ? ' ' : c;
    if (plain != ' ' || (!result.empty() && result.back() != ' ')) result += plain;
  }
  return result;
}

/// The first word: up to a blank, bracket or digit.
std::string first_word(std::string_view text) {
  return std::string{text.substr(0, text.find_first_of(" ([0123456789/,:#"))};
}

}  // namespace

std::string folded(std::string_view text) {
  utf8proc_uint8_t* form = nullptr;
  const utf8proc_ssize_t size =
      utf8proc_map(reinterpret_cast<const utf8proc_uint8_t*>(text.data()),
                   static_cast<utf8proc_ssize_t>(text.size()), &form,
                   static_cast<utf8proc_option_t>(UTF8PROC_STABLE | UTF8PROC_COMPOSE | UTF8PROC_COMPAT |
                                                  UTF8PROC_CASEFOLD));
  const std::unique_ptr<utf8proc_uint8_t, void (*)(void*)> owner{form, std::free};
  if (size < 0) return one_blank(text);  // No UTF-8: compared byte by byte.
  return one_blank({reinterpret_cast<const char*>(form), static_cast<std::size_t>(size)});
}

bool is_unit(std::string_view text) {
  const std::string_view bare = without_brackets(text);
  const std::size_t digit = bare.find_first_of("0123456789");
  if (digit == 0 || (digit == 1 && bare.front() == '-')) return bare == "1";  // What a row of numbers has.
  return has(kUnits, bare) || has(kUnitWords, folded(bare)) || (bare.empty() && !trimmed(text).empty());
}

ColumnName column_name(std::string_view heading, std::string_view units_cell) {
  ColumnName column;
  column.text = one_blank(heading);
  column.name = column.text;
  const std::string_view text = column.text;
  for (const auto& [open, close] : {std::pair{'(', ')'}, std::pair{'[', ']'}}) {
    const std::size_t begin = text.rfind(open);
    const std::size_t end = text.find(close, begin == std::string_view::npos ? 0 : begin);
    if (begin == std::string_view::npos || end == std::string_view::npos) continue;
    column.unit = trimmed(text.substr(begin + 1, end - begin - 1));
    column.name = one_blank(std::string{text.substr(0, begin)} + std::string{text.substr(end + 1)});
    break;
  }
  for (const std::string_view mark : {"_", " in ", ", ", "/"}) {
    const std::size_t at = column.text.rfind(mark);
    if (!column.unit.empty() || at == std::string::npos || at == 0) continue;
    const std::string_view unit = text.substr(at + mark.size());
    if (!has(kUnits, unit) || unit == "-" || unit == "1" || unit == "in") continue;
    column.unit = unit;
    column.name = trimmed(text.substr(0, at));
  }
  if (const std::string_view unit = without_brackets(units_cell); !unit.empty()) column.unit = unit;
  return column;
}

int time_rank(const ColumnName& column) {
  const std::string whole = folded(column.name);
  const std::string word = first_word(whole);
  // The time of a part begins anew with each part.
  const bool is_of_part = std::any_of(kParts.begin(), kParts.end(), [&](std::string_view part) {
    return whole.find(part) != std::string::npos;
  });
  if (word == "t") return 1;
  return has(kTimes, word) || word.starts_with("time_") || word.ends_with("_time") || word == "date" ||
                 whole.find(" time") != std::string::npos
             ? (is_of_part ? 1 : 2)
             : 0;
}

bool is_scan_counter(const ColumnName& column) {
  // "I (A)" is a current.
  constexpr std::array<std::string_view, 5> kNoUnits{"", "-", "1", "#", "RN"};  // RN: Campbell's.
  if (!has(kNoUnits, column.unit)) return false;
  const std::string name = folded(column.name);
  if (has(kNumberWords, name)) return true;
  std::string_view word = name;
  const std::size_t end = word.find_last_of(" _");
  if (word.ends_with('#')) {
    word.remove_suffix(1);
  } else if (end != std::string_view::npos && has(kNumberWords, word.substr(end + 1))) {
    word = word.substr(0, end);
  }
  word = trimmed(word);
  if (word.ends_with('.') || (word.ends_with('s') && word.size() > 1)) word.remove_suffix(1);
  return has(kCounted, word);
}

}  // namespace stickslip::traces
