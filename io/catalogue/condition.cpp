#include "io/catalogue/condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"
#include "core/model/regime.hpp"
#include "core/record/metadata.hpp"

namespace stickslip::catalogue {
namespace {

using Names = std::set<std::string, std::less<>>;

constexpr std::array<const char*, 5> kTextColumns{"sample", "grade", "operator", "batch", "method"};

/// For LIKE with ESCAPE '\'.
std::string like_pattern(std::string_view typed) {
  std::string pattern;
  for (const char letter : typed) {
    if (letter == '%' || letter == '_' || letter == '\\') pattern += '\\';
    pattern += letter == '*' ? '%' : letter == '?' ? '_' : letter;
  }
  return pattern;
}

Condition any_of(const std::vector<Condition>& conditions) {
  Condition either;
  for (const Condition& one : conditions) {
    either.sql += (either.sql.empty() ? "(" : " OR ") + one.sql;
    either.values.insert(either.values.end(), one.values.begin(), one.values.end());
  }
  either.sql += ")";
  return either;
}

/// The record's names and the short ones.
const std::map<std::string, std::string, std::less<>>& result_columns() {
  static const auto columns = [] {
    const analysis::TestResults none;
    std::map<std::string, std::string, std::less<>> all{{"S", "mu_s"},
                                                        {"K", "mu_k"},
                                                        {"S-K", "delta_mu"},
                                                        {"static", "static_coefficient"},
                                                        {"kinetic", "kinetic_coefficient"}};
    analysis::for_each_result(none, [&](const analysis::ResultName& name, const analysis::Estimate&) {
      all.emplace(name.name, name.name);
    });
    return all;
  }();
  return columns;
}

Names names_of_results() {
  Names names;
  for (const auto& [name, column] : result_columns()) names.insert(name);
  return names;
}

/// One side of a range. \return nothing if it is no finite number.
std::optional<double> number_in(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

Condition is_like(Text text, const std::vector<std::string>& patterns) {
  const std::string column = kTextColumns.at(static_cast<std::size_t>(text));
  std::vector<Condition> all;
  for (const std::string& typed : patterns) {
    const std::string pattern = like_pattern(typed);
    all.push_back({column + " LIKE ? ESCAPE '\\'", {pattern}});
    // "penner-1995 kinetic_cycles=10"
    if (text == Text::kMethod) all.push_back({column + " LIKE ? ESCAPE '\\'", {pattern + " %"}});
  }
  return any_of(all);
}

Condition begins_in(const std::optional<Moment>& begin, const std::optional<Moment>& end) {
  Condition between{"1", {}};
  if (begin) {
    between.sql += " AND start_ns >= ?";
    between.values.emplace_back(begin->begin_ns);
  }
  if (end) {
    between.sql += " AND start_ns < ?";
    between.values.emplace_back(end->end_ns);
  }
  return between;
}

base::Result<Condition> has_regime(const std::vector<std::string>& regimes, const std::string& place) {
  std::vector<Condition> all;
  for (const std::string& regime : regimes) {
    if (!model::regime_from_name(regime)) {
      Names known;
      for (const auto& [value, name] : model::kRegimeNames) known.emplace(name);
      return base::usage_error("{} {}: there is no such regime; {}", place, base::one_line(regime),
                               base::spelling_hint(regime, known));
    }
    all.push_back({"regime = ?", {regime}});
  }
  return any_of(all);
}

base::Result<Condition> has_finding(const std::vector<std::string>& findings, const std::string& place) {
  Names known{"any", "none"};
  for (const base::FindingKind& kind : base::finding_kinds()) known.emplace(kind.name);
  for (const base::Severity severity : base::kSeverities) known.emplace(base::name(severity));
  std::vector<Condition> all;
  for (const std::string& finding : findings) {
    if (!known.contains(finding)) {
      return base::usage_error("{} {}: there is no such finding; {}", place, base::one_line(finding),
                               base::spelling_hint(finding, known));
    }
    if (finding == "any" || finding == "none") {
      all.push_back({finding == "any" ? "codes <> ''" : "codes = ''", {}});
    } else {
      all.push_back({"instr(codes, ?) > 0", {" " + finding + " "}});
    }
  }
  return any_of(all);
}

base::Result<Condition> in_range(const std::string& text, const std::string& place) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const auto column = result_columns().find(name);
  if (column == result_columns().end()) {
    return base::usage_error("{} {}: there is no result called \"{}\"; {}", place, base::one_line(text),
                             base::one_line(name), base::spelling_hint(name, names_of_results()));
  }
  const std::size_t colon = equals == std::string::npos ? equals : text.find(':', equals);
  const auto wrong = [&] {
    return base::usage_error(
        "{} {}: must be RESULT=LOWEST:HIGHEST, such as {}=0.3:0.4 or {}=:0.4, in SI units", place,
        base::one_line(text), name, name);
  };
  if (colon == std::string::npos || text.size() == equals + 2) return wrong();
  Condition range{fmt::format("\"{}\" IS NOT NULL", column->second), {}};
  for (const auto& [compare, side] : {std::pair{">=", text.substr(equals + 1, colon - equals - 1)},
                                      std::pair{"<=", text.substr(colon + 1)}}) {
    if (side.empty()) continue;
    const std::optional<double> value = number_in(side);
    if (!value) return wrong();
    range.sql += fmt::format(" AND \"{}\" {} ?", column->second, compare);
    range.values.emplace_back(*value);
  }
  return range;
}

base::Result<Condition> has_fact(const std::string& text, const std::string& place) {
  const auto fact = record::split_fact(text);
  if (!fact) return base::usage_error("{}: {}", place, fact.error().message);
  const auto& [key, wanted] = *fact;
  const auto known = record::known_facts();
  const auto number = std::find_if(known.begin(), known.end(), [&key = key](const record::KnownFact& one) {
    return one.key == key && !one.unit.empty();
  });
  const std::size_t colon = wanted.find(':');
  if (number == known.end() || colon == std::string::npos) {
    return Condition{
        "EXISTS (SELECT 1 FROM json_each(nullif(facts, '')) WHERE key = ? AND value LIKE ? ESCAPE '\\')",
        {key, like_pattern(wanted)}};
  }
  const std::string column = fmt::format("json_extract(fact_numbers, '$.{}')", number->key);
  Condition range{column + " IS NOT NULL", {}};
  for (const auto& [compare, side] :
       {std::pair{">=", wanted.substr(0, colon)}, std::pair{"<=", wanted.substr(colon + 1)}}) {
    if (side.empty()) continue;
    const auto value = base::parse_quantity(side, number->dimension);
    if (!value) {
      return base::usage_error("{} {}: {}; write it like \"{}={}:\"", place, base::one_line(text),
                               value.error().message, key, number->example);
    }
    range.sql += fmt::format(" AND {} {} ?", column, compare);
    range.values.emplace_back(*value);
  }
  return range;
}

base::Result<std::string> sort_column(const std::string& key, const std::string& place) {
  if (key == "date") return std::string{"start_ns"};
  Names known = names_of_results();
  for (const char* const column : {"sample", "grade", "operator", "batch", "method", "regime"}) {
    if (key == column) return key;
    known.emplace(column);
  }
  known.emplace("date");
  if (const auto found = result_columns().find(key); found != result_columns().end()) return found->second;
  return base::usage_error("{} {}: records cannot be sorted by that; {}", place, base::one_line(key),
                           base::spelling_hint(key, known));
}

}  // namespace stickslip::catalogue
