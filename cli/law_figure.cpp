#include "cli/law_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "report/millimetres.hpp"

#include "core/base/nan.hpp"

namespace stickslip::cli {
namespace {

/// From the lowest place to the highest; `shown` is the place on the axis.
plot::Curve curve_of(const std::function<double(double)>& law, double low, double high,
                     const std::function<double(double)>& shown) {
  plot::Curve curve;
  constexpr int kSteps = 50;  // A line over a logarithmic axis is no straight one.
  for (int i = 0; i <= kSteps; ++i) {
    const double place = low + (high - low) * i / kSteps;
    curve.x.push_back(shown(place));
    curve.y.push_back(law(place));
  }
  return curve;
}

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
  for (std::size_t i = 0; i < own.points.size(); ++i) {
    const law::Point& point = own.points[i];
    low = std::min(low, point.x);
    high = std::max(high, point.x);
    points.x.push_back(shown(point.x));
    points.y.push_back(point.y);
    for (const double y : {point.y - point.error, point.y + point.error, base::kNaN}) {
      errors.x.push_back(shown(point.x));
      errors.y.push_back(y);
    }
  }
  const auto draw = [&](const std::function<double(double)>& law, std::string label, bool chosen,
                        plot::Colour colour) {
    plot::Curve curve = curve_of(law, low, high, shown);
    curve.label = std::move(label);
    curve.style = chosen ? plot::CurveStyle::kLine : plot::CurveStyle::kDashed;
    curve.colour = colour;
    panel.curves.push_back(std::move(curve));
  };
  if (both != nullptr) {
    plot::Curve law{
        .label = "rate-and-state", .style = plot::CurveStyle::kPoints, .colour = plot::Colour::kVermilion};
    for (std::size_t i = 0; i < own.points.size(); ++i) {
      if (!both->S[own.tests[i]]) continue;
      law.x.push_back(shown(own.points[i].x));
      law.y.push_back(*both->S[own.tests[i]]);
    }
    panel.curves.push_back(std::move(law));
  } else {
    if (own.constant)
      draw([&](double place) { return own.constant->predicted(place).value; },
           fmt::format("{} constant", symbol), !with_slope, plot::Colour::kBlue);
    if (own.line)
      draw([&](double place) { return own.line->predicted(place).value; },
           fmt::format("{} depends on it", symbol), with_slope, plot::Colour::kVermilion);
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
