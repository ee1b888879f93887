#include "report/trace_json.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "report/millimetres.hpp"
#include "report/plot/figure.hpp"
#include "report/plot/thinning.hpp"
#include "report/record_trace.hpp"
#include "report/rounded_json.hpp"
#include <nlohmann/json.hpp>

#include "core/base/long_column.hpp"
#include "core/base/nan.hpp"

namespace stickslip::report {
namespace {

using Json = nlohmann::ordered_json;

RecordTrace thinned(RecordTrace trace) {
  if (trace.time_s.size() <= kMostPointsOnPage) return trace;
  const plot::AxisRange whole{trace.time_s.front(), trace.time_s.back()};
  const plot::Curve curve{.label = {}, .x = std::move(trace.time_s), .y = std::move(trace.value)};
  RecordTrace thin;
  for (const plot::Polyline& piece :
       plot::visible_pieces(curve, whole, false, false, kMostPointsOnPage / 2)) {
    if (!thin.time_s.empty()) {
      thin.time_s.push_back(piece.x.front());
      thin.value.push_back(base::kNaN);
    }
    thin.time_s.insert(thin.time_s.end(), piece.x.begin(), piece.x.end());
    thin.value.insert(thin.value.end(), piece.y.begin(), piece.y.end());
  }
  return thin;
}

/// {"start": …, "step": …, "value": […]}; where the times are no equal steps, {"time": […], "value": […]}.
Json series_json(const RecordTrace& trace) {
  constexpr double kOfAStep = 1e-6;
  const std::size_t count = trace.time_s.size();
  const double step =
      count < 2 ? 0.0 : (trace.time_s.back() - trace.time_s.front()) / static_cast<double>(count - 1);
  bool is_even = step > 0.0;
  for (std::size_t i = 0; i < count && is_even; ++i) {
    is_even =
        std::abs(trace.time_s[i] - trace.time_s.front() - static_cast<double>(i) * step) <= kOfAStep * step;
  }
  if (!is_even) return {{"time", rounded(trace.time_s)}, {"value", rounded(trace.value)}};
  return {{"start", trace.time_s.front()}, {"step", step}, {"value", rounded(trace.value)}};
}

Json cycles_json(const base::LongColumn<detect::Cycle>& cycles) {
  Json json{{"time", Json::array()}, {"peak", Json::array()}, {"captured", Json::array()}};
  for (const detect::Cycle& cycle : cycles) {
    json["time"].push_back(rounded(cycle.peak_time_s));
    json["peak"].push_back(rounded(cycle.peak));
    json["captured"].push_back((cycle.flags & detect::kCycleCaptured) != 0);
  }
  return json;
}

/// Time at which the force was last at or above half of its maximum. What follows is unloading, as in the
/// rule of the traditional numbers.
double end_of_pull_s(const RecordTrace& trace) {
  double largest = 0.0;
  for (const double value : trace.value) {
    if (value > largest) largest = value;  // Not with a break.
  }
  for (std::size_t i = trace.value.size(); i-- > 0;) {
    if (trace.value[i] >= 0.5 * largest) return trace.time_s[i];
  }
  return 0.0;
}

/// Time of a slip's onset; that of its peak if the onset was not estimated.
double start_s(const detect::Cycle& cycle) {
  return std::isfinite(cycle.onset_time_s) ? cycle.onset_time_s : cycle.peak_time_s;
}

/// \param last_slides  true: the last slip goes on to the end of the pull.
Json modes_json(const base::LongColumn<detect::Cycle>& cycles, double end_s, bool last_slides) {
  Json json = Json::array();
  const auto add = [&json](double from_s, double to_s, const char* mode) {
    if (from_s < to_s) json.push_back(Json::array({rounded(from_s), rounded(to_s), mode}));
  };
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const detect::Cycle cycle = cycles[i];
    const bool last = i + 1 == cycles.size();
    if (std::isfinite(cycle.capture_time_s)) {
      add(start_s(cycle), cycle.capture_time_s, "slip");
      if (!last) add(cycle.capture_time_s, start_s(cycles[i + 1]), "stick");
    } else if ((cycle.flags & detect::kCycleCaptured) == 0 && (!last || last_slides)) {
      // One that is known to have stuck, but not when, is neither.
      add(start_s(cycle), last ? end_s : start_s(cycles[i + 1]), "slide");
    }
  }
  return json;
}

Json second_json(const record::Record& record) {
  std::optional<RecordTrace> trace = second_trace(record);
  if (!trace) return nullptr;
  for (double& value : trace->value) value *= kMillimetresPerMetre;
  const RecordTrace shown = thinned(*std::move(trace));
  const daq::SecondQuantity quantity = record.header.board.second->quantity;
  Json json = series_json(shown);
  json["unit"] = quantity == daq::SecondQuantity::kPullSpeed ? "mm/s" : "mm";
  json["name"] = daq::name(quantity);
  return json;
}

}  // namespace

base::Result<Json> trace_json(const record::Record& record) {
  base::Result<RecordTrace> trace = coefficient_trace(record);
  if (!trace) return tl::unexpected(trace.error());
  const std::optional<double> scaled = stretch_m(record);
  const double factor = scaled ? kMillimetresPerMetre * *scaled : 1.0;
  RecordTrace slope = derivative(*trace, factor);
  const double end_s = end_of_pull_s(*trace);

  Json json;
  json["scan_count"] = record.scan.size();
  json["rate"] = record.header.board.scan_rate_granted_Hz;
  json["thinned"] = trace->time_s.size() > kMostPointsOnPage;
  const RecordTrace force = thinned(std::move(*trace));
  json["force"] = series_json(force);
  slope = thinned(std::move(slope));
  json["slope"] = series_json(slope);
  json["slope"]["unit"] = scaled ? "mm/s" : "1/s";
  const std::optional<double>& speed = record.header.tester.pull_speed_m_per_s;
  json["slope"]["limit"] = scaled && speed ? Json(*speed * kMillimetresPerMetre) : Json(nullptr);
  json["second"] = second_json(record);
  json["cycles"] = cycles_json(record.cycles);
  // In a stick-slip test the end of the pull interrupted the last slip, so its end is unknown.
  const model::Regime regime = record.end->results.regime;
  const bool last_slides = regime == model::Regime::kRingDown || regime == model::Regime::kMixed ||
                           regime == model::Regime::kInertialOscillation;
  json["modes"] = modes_json(record.cycles, end_s, last_slides);
  const analysis::Estimate& transition = record.end->results.transition_time;
  json["transition"] = transition.value ? Json(*transition.value) : Json(nullptr);
  return json;
}

}  // namespace stickslip::report
