#include "daemon/types/trend_state.hpp"

#include "io/or_null.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::daemon {

using Json = nlohmann::ordered_json;

TrendState trend_state(const trend::TesterCharts& charts) {
  TrendState all;
  all.reference = charts.reference();
  all.findings = charts.findings();
  for (std::size_t i = 0; i < trend::kQuantities; ++i) {
    const auto quantity = static_cast<trend::Quantity>(i);
    const trend::ChartState& state = charts.state(quantity);
    const trend::ControlChart& chart = state.chart;
    TrendState::Chart own{.quantity = quantity,
                          .verdict = state.verdict(),
                          .test_count = chart.count(),
                          .mean = {},
                          .standard_deviation = {},
                          .latest = state.latest,
                          .upper = chart.upper(),
                          .lower = chart.lower(),
                          .outside_count = state.outside_count,
                          .reason = state.no_value_reason,
                          .alarm = state.alarm};
    if (chart.count() > 0) own.mean = chart.mean();
    if (chart.count() > 1) own.standard_deviation = chart.standard_deviation();
    all.charts.push_back(std::move(own));
  }
  return all;
}

Json trend_json(const TrendState& state) {
  Json charts = Json::array();
  for (const TrendState::Chart& chart : state.charts) {
    const trend::ChartKind& kind = trend::kind_of(chart.quantity);
    Json alarm;
    if (chart.alarm) {
      alarm = {{"rises", chart.alarm->rises},      {"shift", io::or_null(chart.alarm->shift)},
               {"since", chart.alarm->since_time}, {"since_file", chart.alarm->since_file},
               {"told", chart.alarm->told_time},   {"told_file", chart.alarm->told_file}};
    }
    charts.push_back({{"chart", kind.name},
                      {"unit", kind.unit},
                      {"verdict", trend::name(chart.verdict)},
                      {"test_count", chart.test_count},
                      {"mean", io::or_null(chart.mean)},
                      {"standard_deviation", io::or_null(chart.standard_deviation)},
                      {"latest", io::or_null(chart.latest)},
                      {"upper", chart.upper},
                      {"lower", chart.lower},
                      {"outside_count", chart.outside_count},
                      {"reason", io::or_null(chart.reason)},
                      {"alarm", std::move(alarm)}});
  }
  return {{"reference", io::or_null(state.reference)},
          {"charts", std::move(charts)},
          {"trouble", io::or_null(state.trouble)}};
}

Json trend_course_json(const trend::TesterCharts& charts, const TrendState& state) {
  Json json = trend_json(state);
  json["reference_value"] = trend::kReferenceValue;
  json["decision_interval"] = trend::kDecisionInterval;
  for (std::size_t i = 0; i < state.charts.size(); ++i) {
    Json points{{"time", Json::array()},
                {"file", Json::array()},
                {"value", Json::array()},
                {"upper", Json::array()},
                {"lower", Json::array()}};
    for (const trend::ChartPoint& point : charts.state(state.charts[i].quantity).points) {
      points["time"].push_back(point.time);
      points["file"].push_back(point.file);
      points["value"].push_back(point.value);
      points["upper"].push_back(point.upper);
      points["lower"].push_back(point.lower);
    }
    json["charts"][i]["points"] = std::move(points);
  }
  return json;
}

}  // namespace stickslip::daemon
