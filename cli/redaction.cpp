#include "cli/redaction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <regex>
#include <system_error>

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
constexpr std::size_t kLongestLine = 4000;
/// A shorter secret is not looked for in other text: it would be found in other words.
constexpr std::size_t kShortestSecret = 4;

constexpr auto kRegex = std::regex::ECMAScript | std::regex::optimize;

bool sounds_secret(const std::string& key) {
  static const std::regex secret{"pass(word|wd|phrase)|pwd|secret|token|credential|api_?key|psk",
                                 kRegex | std::regex::icase};
  return std::regex_search(key, secret) && !key.ends_with("_file");
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

std::string unquoted(std::string value) {
  boost::algorithm::trim_if(value, [](char c) { return c == '"' || c == '\''; });
  return value;
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

/// TOML line by line, so that it need not be valid. A value stays if `shows` its key; a line that is neither
/// table nor value, nor element of a shown array, is removed.
/// \param shows  is called with the dotted path of the key, and the value.
std::string filtered_toml(std::string_view text,
                          const std::function<bool(const std::string& key, const std::string& value)>& shows,
                          const std::function<bool(const std::string& table)>& shows_table) {
  std::string table;
  bool in_array = false;
  std::string result = each_line(text, [&](std::string_view whole) -> std::string {
    const std::string line = without_comment(whole);
    if (line.empty()) return {};
    if (in_array && (line.front() == '"' || line.front() == '\'' || line.front() == ']')) {
      in_array = line.back() != ']';
      return "  " + line;
    }
    in_array = false;
    if (line.front() == '[') {
      table = bare(boost::algorithm::trim_copy_if(line, [](char c) { return c == '[' || c == ']'; }));
      return shows_table(table) ? line : std::string{kRemoved};
    }
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) return std::string{kRemoved};
    const std::string name = bare(line.substr(0, equals));
    const std::string value = boost::algorithm::trim_copy(line.substr(equals + 1));
    const bool shown = shows(table.empty() ? name : table + "." + name, value);
    in_array = shown && value.starts_with('[') && !value.ends_with(']');
    return fmt::format("{} = {}", name, shown ? std::string_view{value} : kRemoved);
  });
  while (boost::algorithm::contains(result, "\n\n\n"))
    boost::algorithm::replace_all(result, "\n\n\n", "\n\n");
  return boost::algorithm::trim_left_copy(result);
}

}  // namespace

Redaction::Redaction(bool keeps_names) : keeps_names_(keeps_names) {
  for (std::string& key : io::config_keys()) known_keys_.insert(std::move(key));
}

bool Redaction::shows(const std::string& key) const {
  if (key == "fleet.user") return false;
  if (!keeps_names_ && key.starts_with("sample.") && key != "sample.replicate") return false;
  return known_keys_.contains(key);
}

std::string Redaction::configuration(std::string_view text, const std::filesystem::path& folder) {
  const auto shown = [&](const std::string& key, const std::string& value) {
    const bool names_secret = std::ranges::find(kSecretFiles, key) != std::end(kSecretFiles);
    const std::string name = unquoted(value);
    std::error_code error;
    const bool is_file = std::filesystem::exists(
        key == "control.token_file" ? std::filesystem::path{name} : folder / name, error);
    const bool hidden = names_secret ? !is_file : !known_keys_.contains(key) && sounds_secret(key);
    // Usual names of files that are not there yet; all other text would lose these words.
    const bool is_word = name == "token" || name == "password" || name == "key";
    if (hidden && name.size() >= kShortestSecret && !is_word) secrets_.push_back(name);
    return shows(key) && !hidden;
  };
  return filtered_toml(text, shown, [this](const std::string& table) {
    const auto next = known_keys_.lower_bound(table + ".");
    return next != known_keys_.end() && next->starts_with(table + ".");
  });
}

std::string Redaction::toml(std::string_view text) const {
  return filtered_toml(
      text,
      [this](const std::string& key, const std::string&) {
        return !sounds_secret(key) && (keeps_names_ || (key != "certificate" && key != "operator"));
      },
      [](const std::string&) { return true; });
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
  for (const std::string& secret : secrets_) boost::algorithm::replace_all(text, secret, kRemoved);
  // Of a message that refuses a key: its value, quoted up to the last quote.
  static const std::regex refused{R"re(([\w-]+(?:\.[\w-]+)*) = (".*"):|([\w-]+(?:\.[\w-]+)+) = ([^":]+):)re",
                                  kRegex};
  std::string result;
  std::string rest = text;
  for (std::smatch match; std::regex_search(rest, match, refused); rest = match.suffix().str()) {
    const std::string key = match[1].matched ? match[1].str() : match[3].str();
    result += match.prefix().str() + (shows(key) ? match.str() : fmt::format("{} = {}:", key, kRemoved));
  }
  text = result + rest;
  static const std::regex in_url{R"re(://[^\s"']*@)re", kRegex};
  text = std::regex_replace(text, in_url, fmt::format("://{}@", kRemoved));
  static const std::regex said{
      R"re((password|passwd|passphrase|pwd|secret|token|credentials?|api[_-]?key|psk)(["']?\s*[=:]\s*)("[^"]*"|'[^']*'|[^\s,;]+))re",
      kRegex | std::regex::icase};
  text = std::regex_replace(text, said, fmt::format("$1$2{}", kRemoved));
  static const std::regex bearer{R"re((bearer )\S+)re", kRegex | std::regex::icase};
  text = std::regex_replace(text, bearer, fmt::format("$1{}", kRemoved));
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
