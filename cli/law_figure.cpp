#include "cli/law_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "report/millimetres.hpp"

#include "core/base/nan.hpp"

namespace stickslip::cli {
namespace {

/// Points with their errors, and the lines: those of the law drawn through, the others dashed.
/// \param both  S depends on the speed, too: what the law says of each test. nullptr: it does not.
plot::Panel panel_of(const law::Dependence& own, bool with_slope, const law::RateAndState* both,
                     const char* symbol, plot::Axis x, bool x_is_log) {
  plot::Panel panel{.y = {symbol}, .own_x = std::move(x)};
  plot::Curve points{.label = "tests", .style = plot::CurveStyle::kPoints, .colour = plot::Colour::kBlack};
  plot::Curve errors{.style = plot::CurveStyle::kLine, .colour = plot::Colour::kBlack};
  double low = own.points.front().x;
  double high = low;
  const auto shown = [x_is_log](double place) {
    return x_is_log ? std::pow(10.0, place) : report::kMillimetresPerMetre * place;
  };
  for (const law::Point& point : own.points) {
    low = std::min(low, point.x);
    high = std::max(high, point.x);
    points.x.push_back(shown(point.x));
    points.y.push_back(point.y);
    for (const double y : {point.y - point.error, point.y + point.error, base::kNaN}) {
      errors.x.push_back(shown(point.x));
      errors.y.push_back(y);
    }
  }
  if (both != nullptr) {
    plot::Curve law{
        .label = "rate-and-state", .style = plot::CurveStyle::kPoints, .colour = plot::Colour::kVermilion};
    for (std::size_t i = 0; i < own.points.size(); ++i) {
      if (!both->S[own.tests[i]]) continue;
      law.x.push_back(shown(own.points[i].x));
      law.y.push_back(*both->S[own.tests[i]]);
    }
    panel.curves.push_back(std::move(law));
  }
  for (const bool slope : {false, true}) {
    const std::optional<law::Line>& line = own.fitted(slope);
    if (!line || both != nullptr) continue;
    plot::Curve curve{
        .label = slope ? fmt::format("{} depends on it", symbol) : fmt::format("{} constant", symbol),
        .style = slope == with_slope ? plot::CurveStyle::kLine : plot::CurveStyle::kDashed,
        .colour = slope ? plot::Colour::kVermilion : plot::Colour::kBlue};
    constexpr int kSteps = 50;  // A line over a logarithmic axis is no straight one.
    for (int i = 0; i <= kSteps; ++i) {
      const double place = low + (high - low) * i / kSteps;
      curve.x.push_back(shown(place));
      curve.y.push_back(line->predicted(place).value);
    }
    panel.curves.push_back(std::move(curve));
  }
  panel.curves.push_back(std::move(errors));
  panel.curves.push_back(std::move(points));
  return panel;
}

}  // namespace

const char* in_words(const law::FrictionLaw& found) {
  if (found.is_rate_and_state()) return "S depends on the time at rest and on the speed";
  switch (found.law) {
    case law::Law::kConstant:
      return "S and K are constant";
    case law::Law::kAgeing:
      return "S depends on the time at rest, K is constant";
    case law::Law::kRate:
      return "S is constant, K depends on the speed";
    case law::Law::kAgeingAndRate:
      return "S depends on the time at rest, K on the speed";
  }
  return "";
}

plot::Figure law_figure(const law::FrictionLaw& found) {
  plot::Figure figure;
  figure.title = found.told ? fmt::format("Friction law: {}", in_words(found))
                            : fmt::format("Friction law: cannot be told; {} leads", name(found));
  figure.height_px = 700;
  if (!found.ageing.points.empty()) {
    figure.panels.push_back(panel_of(found.ageing, has_ageing(found.law),
                                     found.is_rate_and_state() ? &*found.rate_and_state : nullptr, "S",
                                     {"time at rest before the slip (s)", true}, true));
  }
  if (!found.rate.points.empty()) {
    figure.panels.push_back(
        panel_of(found.rate, has_rate(found.law), nullptr, "K", {"pull speed (mm/s)"}, false));
  }
  figure.notes = {"bars: standard error of each test; dashed: the law that was not chosen"};
  return figure;
}

}  // namespace stickslip::cli
