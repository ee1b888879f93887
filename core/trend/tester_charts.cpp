#include "core/trend/tester_charts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace stickslip::trend {
namespace {

/// Relative difference of pull speeds up to which two tests of the reference paper are compared: K of paper
/// changes by some per cent in a decade of speed, so this much changes it far less than its scatter.
constexpr double kSameSpeed = 0.05;

std::optional<double> finite(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? value : std::nullopt;
}

constexpr std::size_t index_of(Quantity quantity) { return static_cast<std::size_t>(quantity); }

}  // namespace

const std::array<ChartKind, kQuantities>& chart_kinds() noexcept {
  using enum base::FindingCode;
  static constexpr std::array<ChartKind, kQuantities> kKinds{{
      {"reference", "1", "the reference paper", "", kTrendReference},
      {"omega", "rad/s", "omega", "omega_rad_per_s", kTrendOmega},
      {"damping", "1", "gamma/2omega", "gamma_over_2omega", kTrendDamping},
      {"zero", "N", "the zero", "zero_N", kTrendZero},
      {"noise", "N", "the noise", "noise_N", kTrendNoise},
      {"spikes", "1", "spikes per scan", "spikes_per_scan", kTrendSpikes},
      {"rate", "1", "the scan rate, measured over granted less 1,", "scan_rate_error", kTrendRate},
  }};
  return kKinds;
}

const ChartKind& kind_of(Quantity quantity) noexcept { return chart_kinds()[index_of(quantity)]; }

std::optional<Quantity> quantity_from_name(std::string_view name) noexcept {
  for (std::size_t i = 0; i < kQuantities; ++i) {
    if (chart_kinds()[i].name == name) return static_cast<Quantity>(i);
  }
  return std::nullopt;
}

std::string_view name(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kOff:
      break;
    case Verdict::kLearning:
      return "learning";
    case Verdict::kInControl:
      return "in control";
    case Verdict::kAlarm:
      return "alarm";
  }
  return "off";
}

Verdict ChartState::verdict() const noexcept {
  if (alarm) return Verdict::kAlarm;
  if (chart.count() == 0) return Verdict::kOff;
  return chart.count() < kFullBaseline ? Verdict::kLearning : Verdict::kInControl;
}

std::optional<double> TesterCharts::reference_value(const TestValues& test, std::string& why) {
  if (reference_.empty()) {
    why = "no reference paper is configured: name it as [trend] reference";
    return std::nullopt;
  }
  if (test.sample != reference_) {
    why = fmt::format("the sample is not the reference paper, {}", reference_);
    return std::nullopt;
  }
  const std::optional<double> delta_mu = finite(test.delta_mu);
  const std::optional<double> mu_k = finite(test.mu_k);
  const Compared compared = compared_ ? *compared_ : Compared{delta_mu.has_value(), test.pull_speed_m_per_s};
  if (test.pull_speed_m_per_s.has_value() != compared.pull_speed_m_per_s.has_value() ||
      (compared.pull_speed_m_per_s && std::abs(*test.pull_speed_m_per_s - *compared.pull_speed_m_per_s) >
                                          kSameSpeed * *compared.pull_speed_m_per_s)) {
    why = compared.pull_speed_m_per_s ? fmt::format("the pull speed is not that of the chart, {:.4g} m/s",
                                                    *compared.pull_speed_m_per_s)
                                      : std::string{"the chart is of tests without a known pull speed"};
    return std::nullopt;
  }
  const std::optional<double> value = compared.is_delta_mu ? delta_mu : mu_k;
  if (value) {
    compared_ = compared;
  } else {
    why = compared.is_delta_mu ? "the test has no S - K" : "the test has no K";
  }
  return value;
}

std::vector<Quantity> TesterCharts::add(const TestValues& test) {
  std::vector<Quantity> alarmed;
  for (std::size_t i = 0; i < kQuantities; ++i) {
    const auto quantity = static_cast<Quantity>(i);
    ChartState& state = states_[i];
    std::string why = "the test has no such value";
    const std::optional<double> value =
        quantity == Quantity::kReference ? reference_value(test, why) : finite(test.values[i]);
    if (!value) {
      state.no_value_reason = why;
      continue;
    }
    state.no_value_reason.clear();
    tests_[i].push_back({test.time, test.file});
    const std::optional<ChartAlarm> alarm = state.chart.add(*value);
    state.latest = value;
    state.latest_file = test.file;
    if (state.chart.is_outside()) ++state.outside_count;
    state.points.push_back({test.time, test.file, *value,
                            alarm && alarm->rises ? alarm->height : state.chart.upper(),
                            alarm && !alarm->rises ? alarm->height : state.chart.lower()});
    if (state.points.size() > ChartState::kMostPoints) state.points.pop_front();
    // The first alarm stands until somebody acknowledges it.
    if (alarm && !state.alarm) {
      const TestName& since = tests_[i].end()[alarm->onset - alarm->told - 1];
      state.alarm =
          StandingAlarm{alarm->rises, alarm->shift, alarm->standard_deviation, since.time, since.file,
                        test.time,    test.file};
      alarmed.push_back(quantity);
    }
    while (std::ssize(tests_[i]) > state.chart.excursion_count()) tests_[i].pop_front();
  }
  return alarmed;
}

void TesterCharts::restart(Quantity quantity, bool baseline_stays) {
  ChartState& state = states_[index_of(quantity)];
  if (baseline_stays) {
    state.alarm.reset();
    state.chart.restart_arms();
    return;
  }
  state = {};
  state.no_value_reason = "no test since the restart";
  tests_[index_of(quantity)].clear();
  if (quantity == Quantity::kReference) compared_.reset();
}

std::vector<base::Finding> TesterCharts::findings() const {
  std::vector<base::Finding> findings;
  for (std::size_t i = 0; i < kQuantities; ++i) {
    const std::optional<StandingAlarm>& alarm = states_[i].alarm;
    if (!alarm) continue;
    const ChartKind& kind = chart_kinds()[i];
    const std::string_view unit = kind.unit == "1" ? "" : kind.unit;
    const double size = std::abs(alarm->shift);
    const std::string in_deviations =
        alarm->standard_deviation > 0.0
            ? fmt::format(" ({:.1f} standard deviations)", size / alarm->standard_deviation)
            : std::string{};
    base::add(findings, base::make_finding(
                            kind.code,
                            fmt::format("{} {} by about {:.3g}{}{}{} with the test of {} ({})", kind.meaning,
                                        alarm->rises ? "rose" : "fell", size, unit.empty() ? "" : " ", unit,
                                        in_deviations, alarm->since_time, alarm->since_file),
                            {{"shift", alarm->shift, std::string{kind.unit}},
                             {"standard_deviation", alarm->standard_deviation, std::string{kind.unit}}}));
  }
  return findings;
}

}  // namespace stickslip::trend
