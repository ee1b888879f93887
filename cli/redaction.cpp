#include "cli/redaction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <regex>

#include "io/config.hpp"
#include <boost/algorithm/string/predicate.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <boost/algorithm/string/trim.hpp>
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kRemoved = "[removed]";
constexpr std::string_view kNameLeftOut = "[name left out]";
/// Longer lines are no line of ours, and std::regex recurses for each byte.
constexpr std::size_t kLongestLine = 500;

constexpr auto kRegex = std::regex::ECMAScript | std::regex::optimize;

bool sounds_secret(const std::string& key) {
  static const std::regex secret{"pass(word|wd|phrase)|pwd|secret|token|credential|api_?key|psk",
                                 kRegex | std::regex::icase};
  return key.ends_with("_file") || key.ends_with("user") || std::regex_search(key, secret);
}

/// Members of JSON that hold what people typed.
bool is_name(std::string_view member, std::string_view parent) {
  static const std::set<std::string, std::less<>> names{
      "operator", "controller",  "under_way_by", "by",       "sample",     "grade", "direction",
      "side",     "source_file", "certificate",  "metadata", "next_facts", "title"};
  return names.contains(member) || (member == "name" && parent != "board");
}

/// The line up to a comment, without blanks at its ends.
std::string without_comment(std::string_view line) {
  char quote = 0;
  std::size_t end = 0;
  for (; end < line.size(); ++end) {
    const char c = line[end];
    if (quote == '"' && c == '\\') {
      ++end;
    } else if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      break;
    }
  }
  // A quote that is not closed protects no comment.
  if (quote != 0) end = line.find('#');
  return boost::algorithm::trim_copy(std::string{line.substr(0, end)});
}

/// A key as a dotted path, without blanks and quotes.
std::string bare(std::string key) {
  std::erase_if(key, [](char c) { return c == ' ' || c == '\t' || c == '"' || c == '\''; });
  return key;
}

/// A number, a switch, or a number with a unit: "1.5", "true", "\"12 in/min\"".
bool is_plain(const std::string& value) {
  static const std::regex plain{R"re(true|false|"?[-+]?[0-9][0-9_.eE+-]*( ?[A-Za-z%/^0-9]{1,8})?"?)re",
                                kRegex};
  return std::regex_match(value, plain);
}

/// A word or a path without anything that could be more: no ':', no '@', no blank at an end.
bool is_word(const std::string& value) {
  static const std::regex word{R"re("[A-Za-z0-9._/-]{1,120}")re", kRegex};
  return std::regex_match(value, word);
}

/// Keys of the configuration whose words are shown; of all others only numbers are.
bool has_words(std::string_view key) {
  static const std::set<std::string, std::less<>> keys{
      "board.driver",       "board.device", "analysis.estimator", "log.level",      "test.begins",
      "method.name",        "method.file",  "record.folder",      "control.socket", "tester.characterisation",
      "tester.calibration", "fleet.tester", "fleet.topic"};
  return keys.contains(key);
}

bool is_address(std::string_view key, const std::string& value) {
  static const std::regex broker{R"re("mqtts?://[A-Za-z0-9.-]+(:[0-9]{1,5})?")re", kRegex};
  static const std::regex http{R"re("(127\.0\.0\.1|localhost|\[::1\]):[0-9]{1,5}")re", kRegex};
  return (key == "fleet.broker" && std::regex_match(value, broker)) ||
         (key == "control.http" && std::regex_match(value, http));
}

/// Calls `use` with each line, and joins what it returns.
std::string each_line(std::string_view text, const std::function<std::string(std::string_view)>& use) {
  std::string result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    result += use(text.substr(0, end)) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

/// TOML line by line, so that it need not be valid. Shown are the values that `shows` allows; of all else not
/// even the key is.
/// \param shows  is called with the dotted path of the key, and the value.
/// \param knows  whether the name of a table or of a key may be shown.
std::string filtered_toml(std::string_view text,
                          const std::function<bool(const std::string& key, const std::string& value)>& shows,
                          const std::function<bool(const std::string& path)>& knows) {
  std::string table;
  std::string result = each_line(text, [&](std::string_view whole) -> std::string {
    const std::string line = without_comment(whole);
    if (line.empty()) return {};
    if (line.front() == '[') {
      table = bare(boost::algorithm::trim_copy_if(line, [](char c) { return c == '[' || c == ']'; }));
      return knows(table) ? line : std::string{kRemoved};
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) return std::string{kRemoved};
    const std::string name = bare(line.substr(0, equals));
    const std::string key = table.empty() ? name : table + "." + name;
    const std::string value = boost::algorithm::trim_copy(line.substr(equals + 1));
    if (!knows(key)) return std::string{kRemoved};
    return fmt::format("{} = {}", name, shows(key, value) ? std::string_view{value} : kRemoved);
  });
  while (boost::algorithm::contains(result, "\n\n\n"))
    boost::algorithm::replace_all(result, "\n\n\n", "\n\n");
  return boost::algorithm::trim_left_copy(result);
}

}  // namespace

Redaction::Redaction(bool keeps_names) : keeps_names_(keeps_names) {
  for (std::string& key : io::config_keys()) known_keys_.insert(std::move(key));
}

std::string Redaction::configuration(std::string_view text) const {
  return filtered_toml(
      text,
      [this](const std::string& key, const std::string& value) {
        if (key.starts_with("sample.")) return keeps_names_ || key == "sample.replicate";
        if (sounds_secret(key)) return false;
        return is_plain(value) || (has_words(key) && is_word(value)) || is_address(key, value);
      },
      [this](const std::string& path) {
        const auto next = known_keys_.lower_bound(path);
        return next != known_keys_.end() && (*next == path || next->starts_with(path + "."));
      });
}

std::string Redaction::toml(std::string_view text) const {
  static const std::regex name{R"re([a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)*)re", kRegex};
  return filtered_toml(
      text,
      [](const std::string& key, const std::string& value) { return !sounds_secret(key) && is_plain(value); },
      [](const std::string& path) { return std::regex_match(path, name); });
}

Json Redaction::json(Json json) const {
  const std::function<void(Json&, const std::string&)> filter = [&](Json& node, const std::string& parent) {
    if (node.is_string()) {
      std::string text = lines(node.get<std::string>());
      if (!text.empty()) text.pop_back();  // The line feed.
      node = text;
    } else if (node.is_array()) {
      for (Json& element : node) filter(element, parent);
    } else if (node.is_object()) {
      for (const auto& [member, value] : node.items()) {
        if (!keeps_names_ && is_name(member, parent) && !value.is_null() && !value.empty()) {
          value = kNameLeftOut;
        } else {
          filter(value, member);
        }
      }
    }
  };
  filter(json, {});
  return json;
}

std::string Redaction::line(std::string_view whole) const {
  if (whole.size() > kLongestLine) return fmt::format("[a line of {} bytes is left out]", whole.size());
  std::string text{whole};
  // A message that refuses a key quotes what was typed.
  if (const std::size_t equals = text.find(" = "); equals != std::string::npos)
    text = text.substr(0, equals + 3).append(kRemoved);
  static const std::regex file{R"re(((password|token|key) file ).*(: ))re", kRegex};
  text = std::regex_replace(text, file, fmt::format("$1{}$3", kRemoved));
  static const std::regex person_at{R"re([^\s"'/]*:[^\s"']*@)re", kRegex};
  text = std::regex_replace(text, person_at, fmt::format("{}@", kRemoved));
  static const std::regex said{
      R"re((pass(word|wd|phrase)?|pwd|secret|token|credentials?|api[_-]?key|private[_-]?key|psk|bearer|basic|authorization|cookie)(["'\\]*\s*[=:]\s*|["'\\]* +(?!file )).+)re",
      kRegex | std::regex::icase};
  text = std::regex_replace(text, said, fmt::format("$1$3{}", kRemoved));
  if (!keeps_names_) {
    // The one line of the log that names a person.
    static const std::regex person{"(load cell calibrated by ).*(: [-+0-9.e]+ N/V)", kRegex};
    text = std::regex_replace(text, person, fmt::format("$1{}$2", kNameLeftOut));
  }
  return text;
}

std::string Redaction::lines(std::string_view text) const {
  return each_line(text, [this](std::string_view one) { return line(one); });
}

}  // namespace stickslip::cli
