#include "cli/sweep/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <utility>

#include "cli/sweep/grid.hpp"
#include "io/table.hpp"
#include <boost/math/statistics/univariate_statistics.hpp>
#include <nlohmann/json.hpp>

namespace stickslip::sweep {
namespace {

/// More are not read any more.
constexpr std::int64_t kMostLines = 40;
constexpr std::size_t kMostColumns = 60;
/// Of model::kRegimeNames, in the map.
constexpr std::string_view kLetters = "SRMIGU";
static_assert(kLetters.size() == model::kRegimeNames.size());
/// Of kJudgedResults, those in the table.
constexpr std::array<std::pair<std::size_t, std::string_view>, 3> kShownErrors{
    {{0, "error of S − K"}, {1, "error of S"}, {2, "error of K"}}};

SweepError error_of(const std::vector<double>& measured, const std::vector<double>& truth, std::size_t first,
                    std::size_t count) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> errors;
  for (std::size_t i = first; i < first + count; ++i) {
    const double error = measured[i] - truth[i];
    if (!std::isnan(error)) errors.push_back(error);
  }
  namespace statistics = boost::math::statistics;
  return {static_cast<std::int64_t>(errors.size()), errors.empty() ? kNone : statistics::mean(errors),
          errors.size() < 2 ? kNone : std::sqrt(statistics::sample_variance(errors))};
}

double share(std::int64_t part, std::int64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

/// "paper.mu_s" → "mu_s": the rest is in the file.
std::string_view short_name(const record::SweepAxis& axis) {
  const std::string_view key = axis.key;
  return key.substr(key.rfind('.') + 1);
}

std::string title_of(const record::SweepAxis& axis) {
  return axis.unit == "1" ? std::string{short_name(axis)}
                          : fmt::format("{} ({})", short_name(axis), axis.unit);
}

/// Without the unit. Six digits: for a look.
std::string shown_value(const record::SweepAxis& axis, std::size_t index) {
  return axis.words.empty() ? fmt::format("{:.6g}", axis.values[index]) : axis.words[index];
}

io::Table::Cell shown_error(const SweepError& error) {
  if (error.count == 0) return {};
  if (error.count == 1) return fmt::format("{:+.5f}", error.mean);
  return fmt::format("{:+.5f} ± {:.5f}", error.mean, error.standard_deviation);
}

/// A line for each point, or, where no axis tells them apart, one for all.
std::string lines(const record::SweepFacts& facts, const record::SweepTable& table, bool by_point) {
  const std::vector<record::SweepAxis> axes = by_point ? facts.axes : std::vector<record::SweepAxis>{};
  std::vector<io::Table::Column> columns;
  for (const record::SweepAxis& axis : axes)
    columns.push_back({.heading = std::string{short_name(axis)}, .unit = axis.unit});
  columns.push_back({.heading = "runs"});
  for (const auto& [regime, word] : model::kRegimeNames) columns.push_back({.heading = std::string{word}});
  columns.push_back({.heading = "right"});
  for (const auto& [index, title] : kShownErrors) columns.push_back({.heading = std::string{title}});
  io::Table shown{std::move(columns)};
  const std::int64_t runs = by_point ? facts.repeat : facts.run_count();
  for (std::int64_t first = 0; first < facts.run_count(); first += runs) {
    const PointSummary point = summary_of(table, first, runs);
    const auto percent = [&](std::int64_t part) {
      return fmt::format("{:.0f} %", 100.0 * share(part, point.run_count));
    };
    std::vector<io::Table::Cell> cells;
    const std::vector<std::size_t> indices = facts.indices_of(first / facts.repeat);
    for (std::size_t i = 0; i < axes.size(); ++i) cells.emplace_back(shown_value(axes[i], indices[i]));
    cells.emplace_back(point.run_count);
    for (const std::int64_t count : point.regimes)
      cells.push_back(count == 0 ? io::Table::Cell{} : percent(count));
    cells.emplace_back(percent(point.regime_right));
    for (const auto& [index, title] : kShownErrors) cells.push_back(shown_error(point.errors[index]));
    shown.add(std::move(cells));
  }
  return shown.text();
}

/// The most frequent regime; a small letter if it is not that of all runs.
char letter_of(const PointSummary& point) {
  const auto most = std::max_element(point.regimes.begin(), point.regimes.end());
  const char letter = kLetters[static_cast<std::size_t>(most - point.regimes.begin())];
  return *most == point.run_count ? letter : static_cast<char>(std::tolower(letter));
}

std::string map(const record::SweepFacts& facts, const record::SweepTable& table) {
  const record::SweepAxis& down = facts.axes[0];
  const record::SweepAxis& across = facts.axes[1];
  const std::size_t last = across.values.size() - 1;
  std::string text = fmt::format("{} down, {} across, {} … {}\n", title_of(down), title_of(across),
                                 shown_value(across, 0), shown_value(across, last));
  io::Table letters{{{.heading = ""}, {.heading = "", .align = io::Table::Align::kLeft}}};
  for (std::size_t i = 0; i < down.values.size(); ++i) {
    std::string line;
    for (std::size_t j = 0; j <= last; ++j) {
      const auto point = static_cast<std::int64_t>(i * across.values.size() + j);
      line += fmt::format("{}{}", j > 0 ? " " : "",
                          letter_of(summary_of(table, point * facts.repeat, facts.repeat)));
    }
    letters.add({shown_value(down, i), line});
  }
  text += letters.text();
  for (std::size_t i = 0; i < kLetters.size(); ++i) {
    text += fmt::format("{} {}, ", kLetters[i], model::kRegimeNames[i].second);
  }
  return text + "small where the runs of a point differ\n\n";
}

}  // namespace

PointSummary summary_of(const record::SweepTable& table, std::int64_t first, std::int64_t count) {
  PointSummary point;
  point.run_count = count;
  const auto begin = static_cast<std::size_t>(first);
  const auto size = static_cast<std::size_t>(count);
  for (std::size_t i = begin; i < begin + size; ++i) {
    ++point.regimes[table.regime()[i]];
    if (table.regime()[i] == table.true_regime()[i]) ++point.regime_right;
  }
  for (std::size_t i = 0; i < kJudgedResults.size(); ++i) {
    point.errors[i] =
        error_of(table.result(kJudgedResults[i]).value, table.truth(kJudgedResults[i]).value, begin, size);
  }
  return point;
}

std::string sweep_table_text(const record::SweepFacts& facts, const record::SweepTable& table) {
  if (facts.point_count() <= kMostLines) return lines(facts, table, true);
  const bool has_map = facts.axes.size() == 2 && facts.axes[1].values.size() <= kMostColumns;
  return (has_map ? map(facts, table) : fmt::format("{} points, all together:\n", facts.point_count())) +
         lines(facts, table, false);
}

nlohmann::ordered_json sweep_points_json(const record::SweepFacts& facts, const record::SweepTable& table) {
  using Json = nlohmann::ordered_json;
  // JSON knows no NaN.
  const auto number = [](double value) { return std::isnan(value) ? Json(nullptr) : Json(value); };
  Json points = Json::array();
  for (std::int64_t i = 0; i < facts.point_count(); ++i) {
    const PointSummary summary = summary_of(table, i * facts.repeat, facts.repeat);
    const std::vector<std::size_t> indices = facts.indices_of(i);
    Json& point = points.emplace_back(Json{{"values", Json::object()}, {"run_count", summary.run_count}});
    for (std::size_t a = 0; a < indices.size(); ++a) {
      const record::SweepAxis& axis = facts.axes[a];
      point["values"][axis.key] =
          axis.words.empty() ? Json(axis.values[indices[a]]) : Json(axis.words[indices[a]]);
    }
    for (std::size_t r = 0; r < summary.regimes.size(); ++r) {
      point["regimes"][std::string{model::kRegimeNames[r].second}] =
          share(summary.regimes[r], summary.run_count);
    }
    point["regime_right"] = share(summary.regime_right, summary.run_count);
    for (std::size_t e = 0; e < kJudgedResults.size(); ++e) {
      const SweepError& error = summary.errors[e];
      point["errors"][std::string{kJudgedResults[e]}] = {
          {"count", error.count},
          {"mean", number(error.mean)},
          {"standard_deviation", number(error.standard_deviation)}};
    }
  }
  return points;
}

}  // namespace stickslip::sweep
