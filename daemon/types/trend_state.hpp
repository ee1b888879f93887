/// \file
/// The control charts of the tester as values, for the status and `stickslip trend`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/base/finding.hpp"
#include "core/trend/tester_charts.hpp"

namespace stickslip::daemon {

struct TrendState {
  struct Chart {
    trend::Quantity quantity = trend::Quantity::kReference;
    trend::Verdict verdict = trend::Verdict::kOff;
    std::int64_t test_count = 0;  ///< Since the restart.
    // Of the baseline; absent with fewer than one and two values.
    std::optional<double> mean;
    std::optional<double> standard_deviation;
    std::optional<double> latest;
    double upper = 0.0;              ///< Arm of the CUSUM, in standard deviations.
    double lower = 0.0;              ///< The same for falling values, ≥ 0.
    std::int64_t outside_count = 0;  ///< Values beyond the Shewhart limits.
    std::string reason;              ///< Why the latest tests gave no value; empty if they did.
    std::optional<trend::StandingAlarm> alarm;
  };
  std::string reference;  ///< Name of the reference paper; empty: none.
  std::vector<Chart> charts;
  std::vector<base::Finding> findings;  ///< Of the standing alarms.
  std::string trouble;                  ///< With the history, for people; empty: none.
};

[[nodiscard]] TrendState trend_state(const trend::TesterCharts& charts);

/// The same with what draws the charts: {"decision_interval": 7.0, …, "charts": [{"chart": "zero", …,
/// "points":
/// {"time": […], "file": […], "value": […], "upper": […], "lower": […]}}]}.
/// \param state  of these charts.
[[nodiscard]] nlohmann::ordered_json trend_course_json(const trend::TesterCharts& charts,
                                                       const TrendState& state);

/// {"reference": …, "charts": [{"chart": "zero", "unit": "N", "verdict": "in control", …}], "trouble": null}
[[nodiscard]] nlohmann::ordered_json trend_json(const TrendState& state);

}  // namespace stickslip::daemon
