#include "cli/sweep/grid.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "core/base/quantity.hpp"
#include "core/base/wording.hpp"

namespace stickslip::sweep {
namespace {

using base::Result;
using record::SweepAxis;

constexpr const char* kForms = "write KEY=FROM:TO:N, KEY=log:FROM:TO:N or KEY=a,b,c";
constexpr std::string_view kNoUnit = "1";

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

struct Quantity {
  double value = 0.0;
  std::string unit;  ///< Empty if there is none.
};

/// Splits number and unit. The unit is checked later, by the scene.
std::optional<Quantity> quantity_of(std::string_view text) {
  text = trimmed(text);
  const char* const end = text.data() + text.size();
  Quantity quantity;
  const auto [stop, error] = std::from_chars(text.data(), end, quantity.value, std::chars_format::general);
  if (error != std::errc{} || !std::isfinite(quantity.value)) return std::nullopt;
  quantity.unit = trimmed({stop, static_cast<std::size_t>(end - stop)});
  return quantity;
}

/// Rounds to 15 digits, so that 0.1 + 0.2 is 0.3.
double rounded(double value) {
  const Result<double> short_value = base::parse_number(fmt::format("{:.15g}", value));
  return short_value ? *short_value : value;
}

std::vector<double> steps(double from, double to, std::int64_t count, bool logarithmic) {
  std::vector<double> values{from};
  const auto last = static_cast<double>(count - 1);
  for (std::int64_t i = 1; i < count - 1; ++i) {
    const double part = static_cast<double>(i) / last;
    values.push_back(rounded(logarithmic ? std::exp(std::lerp(std::log(from), std::log(to), part))
                                         : std::lerp(from, to, part)));
  }
  if (count > 1) values.push_back(to);
  return values;
}

/// \param place  beginning of error messages.
Result<SweepAxis> range_axis(std::string_view key, std::vector<std::string_view> parts,
                             const std::string& place) {
  const bool logarithmic = trimmed(parts.front()) == "log";
  if (logarithmic) parts.erase(parts.begin());
  if (parts.size() != 3) return base::usage_error("{}: {}", place, kForms);
  const auto from = quantity_of(parts[0]);
  const auto to = quantity_of(parts[1]);
  for (const std::size_t i : {0U, 1U}) {
    if (i == 0 ? !from : !to) {
      return base::usage_error("{}: \"{}\" does not begin with a decimal number; {}", place,
                               base::one_line(parts[i]), kForms);
    }
  }
  const std::optional<Quantity> count = quantity_of(parts[2]);
  if (!count || !count->unit.empty() || count->value != std::floor(count->value) || count->value < 1.0 ||
      count->value > static_cast<double>(kMostSweepPoints)) {
    return base::usage_error("{}: \"{}\" values; must be a whole number from 1 to {}", place,
                             base::one_line(trimmed(parts[2])), kMostSweepPoints);
  }
  if (from->unit != to->unit && !from->unit.empty()) {
    return base::usage_error("{}: from \"{}\" to \"{}\"; write both in one unit", place,
                             base::one_line(from->unit), base::one_line(to->unit));
  }
  if (logarithmic && !(from->value > 0.0 && to->value > 0.0)) {
    return base::usage_error("{}: from {} to {}; logarithms need both above 0", place, from->value,
                             to->value);
  }
  return SweepAxis{std::string{key},
                   to->unit.empty() ? std::string{kNoUnit} : to->unit,
                   steps(from->value, to->value, static_cast<std::int64_t>(count->value), logarithmic),
                   {}};
}

Result<SweepAxis> list_axis(std::string_view key, const std::vector<std::string_view>& parts,
                            const std::string& place) {
  SweepAxis axis{std::string{key}, {}, {}, {}};
  std::vector<Quantity> quantities;
  for (const std::string_view part : parts) {
    if (trimmed(part).empty()) return base::usage_error("{}: a value is empty; {}", place, kForms);
    axis.words.emplace_back(trimmed(part));
    if (const auto quantity = quantity_of(part)) quantities.push_back(*quantity);
  }
  const bool numbers = quantities.size() == parts.size();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    axis.values.push_back(numbers ? quantities[i].value : static_cast<double>(i));
  }
  axis.unit = kNoUnit;
  if (!numbers) return axis;
  axis.words.clear();
  for (const Quantity& quantity : quantities) {
    if (quantity.unit != quantities.front().unit) {
      return base::usage_error("{}: \"{}\" and \"{}\"; write all values in one unit", place,
                               base::one_line(quantities.front().unit), base::one_line(quantity.unit));
    }
  }
  if (!quantities.front().unit.empty()) axis.unit = quantities.front().unit;
  return axis;
}

}  // namespace

Result<SweepAxis> parse_axis(std::string_view text) {
  const std::string place = "--vary " + base::one_line(text, 200);
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos || equals == 0 || equals + 1 == text.size()) {
    return base::usage_error("{}: needs a key and values; {}", place, kForms);
  }
  const std::string_view key = text.substr(0, equals);
  const std::string_view values = text.substr(equals + 1);
  if (values.find(':') != std::string_view::npos) return range_axis(key, split(values, ':'), place);
  return list_axis(key, split(values, ','), place);
}

std::string value_text(const SweepAxis& axis, std::size_t index) {
  if (!axis.words.empty()) return axis.words[index];
  if (axis.unit == kNoUnit) return fmt::format("{}", axis.values[index]);
  return fmt::format("{} {}", axis.values[index], axis.unit);
}

Result<std::vector<SweepAxis>> parse_axes(const std::vector<std::string>& options, std::int64_t repeat) {
  std::vector<SweepAxis> axes;
  std::set<std::string, std::less<>> keys;
  double points = 1.0;
  for (const std::string& option : options) {
    Result<SweepAxis> axis = parse_axis(option);
    if (!axis) return tl::unexpected(axis.error());
    if (!keys.insert(axis->key).second) {
      return base::usage_error("--vary {}: the key comes twice; give all its values in one --vary",
                               base::one_line(axis->key));
    }
    points *= static_cast<double>(axis->values.size());
    axes.push_back(*std::move(axis));
  }
  if (points > static_cast<double>(kMostSweepPoints)) {
    return base::usage_error("--vary: {:.0f} points; a sweep may have {}: fewer values", points,
                             kMostSweepPoints);
  }
  const double runs = points * static_cast<double>(repeat);
  if (runs > static_cast<double>(kMostSweepRuns)) {
    return base::usage_error("--repeat {}: {:.0f} runs; a sweep may have {}: fewer of them", repeat, runs,
                             kMostSweepRuns);
  }
  return axes;
}

}  // namespace stickslip::sweep
