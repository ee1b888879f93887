/// \file
/// Conditions on records. The SQL of a condition consists of fixed pieces; what is typed is bound to it.
///
///     Query query;
///     query.conditions.push_back(is_like(Text::kSample, {"liner*"}));
///     query.conditions.push_back(*in_range("S=0.3:0.4", "--where"));
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/catalogue/database.hpp"
#include "io/catalogue/moment.hpp"

#include "core/base/result.hpp"

namespace stickslip::catalogue {

struct Condition {
  std::string sql;
  std::vector<Value> values;
};

/// Texts of a record; the names of the columns are in condition.cpp.
enum class Text { kSample, kGrade, kOperator, kBatch, kMethod };

/// The text is like one of the patterns: * is any text and ? any character; upper and lower case are alike
/// (ASCII). A method is also like the pattern of its name alone.
[[nodiscard]] Condition is_like(Text text, const std::vector<std::string>& patterns);

/// The test began at `begin` or later; before the end of `end`.
[[nodiscard]] Condition begins_in(const std::optional<Moment>& begin, const std::optional<Moment>& end);

/// Errors of these: kUsage, with the place of the text and the words that are known.
[[nodiscard]] base::Result<Condition> has_regime(const std::vector<std::string>& regimes,
                                                 const std::string& place);
/// Codes and severities of findings; "any"; "none". One of them is enough.
[[nodiscard]] base::Result<Condition> has_finding(const std::vector<std::string>& findings,
                                                  const std::string& place);
/// "S=0.3:0.4", "delta_mu=0.02:", "threshold_speed=:0.01": both ends included, SI units.
[[nodiscard]] base::Result<Condition> in_range(const std::string& text, const std::string& place);

/// "lot=47*": a pattern as of is_like(); "temperature=22 degC:24 degC", "humidity=:55 %": a range of a known
/// fact that has a number, both ends included.
[[nodiscard]] base::Result<Condition> has_fact(const std::string& text, const std::string& place);

/// What is found, and in which order.
struct Query {
  std::vector<Condition> conditions = {};  ///< All hold.
  std::string order = {};                  ///< sort_column(); empty: date.
  bool reversed = false;
  std::optional<std::int64_t> most = {};  ///< The first so many.
};

/// Column of "date", "sample", "grade" … or a result; records without a value come last. Error: kUsage.
[[nodiscard]] base::Result<std::string> sort_column(const std::string& key, const std::string& place);

}  // namespace stickslip::catalogue
