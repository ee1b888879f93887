#include "core/analysis/belt_start.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/analysis/slip_estimator.hpp"

namespace stickslip::analysis {
namespace {

/// A rise that starts below this part of its peak is the loading of a test from rest.
constexpr double kFromRest = 0.5;
/// Range of the loading that is fitted, as fractions of the way from rest to the peak. Above it the slip may
/// have begun: S is at least 0.85 of the peak up to the threshold speed, for S − K up to K/6 [Penner 1995,
/// (2)]. Below it the sled may still lag behind the belt's start.
constexpr double kLow = 0.2;
constexpr double kHigh = 0.8;
constexpr std::size_t kFewestStartScans = 4;
/// Fewest scans before the start of which the zero is the mean, and the time before the start at which they
/// end.
constexpr std::size_t kFewestIdle = 16;
constexpr double kIdleEndsBefore_s = 0.01;
constexpr int kIterations = 12;

struct Loading {
  std::vector<double> time_s;
  std::vector<double> value;
  double mean_s = 0.0;
  double mean = 0.0;
  double slope = 0.0;  ///< 1/s
};

Loading loading_of(const estimate::Trace& trace, const detect::Fall& first) {
  const auto peak = std::min(static_cast<std::size_t>(std::lround(first.peak_at)), trace.size() - 1);
  const std::size_t length = std::min(static_cast<std::size_t>(first.rise_duration), peak);
  Loading loading;
  const double range = first.peak - first.rise_from;
  for (std::size_t k = peak - length; k <= peak; ++k) {
    const double level = (trace.value[k] - first.rise_from) / range;
    if (trace.usable[k] == 0 || level < kLow || level > kHigh) continue;
    loading.time_s.push_back(trace.time_s[k]);
    loading.value.push_back(trace.value[k]);
  }
  const auto n = static_cast<double>(loading.value.size());
  for (std::size_t i = 0; i < loading.value.size(); ++i) {
    loading.mean_s += loading.time_s[i] / n;
    loading.mean += loading.value[i] / n;
  }
  double s_tt = 0.0;
  double s_tc = 0.0;
  for (std::size_t i = 0; i < loading.value.size(); ++i) {
    const double dt = loading.time_s[i] - loading.mean_s;
    s_tt += dt * dt;
    s_tc += dt * (loading.value[i] - loading.mean);
  }
  loading.slope = s_tt > 0.0 ? s_tc / s_tt : 0.0;
  return loading;
}

/// Time after the start at which way over speed is what level over slope are in the middle of the loading.
/// \return nothing if the plan never gets there.
std::optional<double> time_since_start(const model::PullSpeed& plan, double way_over_speed_s) {
  const auto beyond = [&](double t_s) {
    const double v = plan.speed_m_per_s(t_s);
    return !(v > 0.0) || plan.travel_m(t_s) >= way_over_speed_s * v;
  };
  const double moves_s = plan.pulls().front().start_s;
  const double stops_s = plan.pulls().front().end_s;
  double low = moves_s;
  double length = way_over_speed_s;
  while (low + length < stops_s && !beyond(low + length)) {
    low += length;
    length *= 2.0;
  }
  double high = std::min(low + length, stops_s);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (plan.travel_m(middle) > 0.0 && beyond(middle) ? high : low) = middle;
  }
  return high < stops_s ? std::optional{high} : std::nullopt;
}

struct Line {
  double rate = 0.0;  ///< Of c, for each m/s of the belt.
  double start_s = 0.0;
};

/// Gauss–Newton for c = zero + rate ∫v.
std::optional<Line> fit_loading(const Loading& loading, const model::PullSpeed& plan, double zero,
                                Line line) {
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    double s_rr = 0.0;
    double s_rt = 0.0;
    double s_tt = 0.0;
    double s_r = 0.0;
    double s_t = 0.0;
    for (std::size_t i = 0; i < loading.value.size(); ++i) {
      const double since_s = loading.time_s[i] - line.start_s;
      const double by_rate = plan.travel_m(since_s);
      const double by_start = -line.rate * plan.speed_m_per_s(since_s);
      const double residual = loading.value[i] - zero - line.rate * by_rate;
      s_rr += by_rate * by_rate;
      s_rt += by_rate * by_start;
      s_tt += by_start * by_start;
      s_r += residual * by_rate;
      s_t += residual * by_start;
    }
    const double determinant = s_rr * s_tt - s_rt * s_rt;
    if (!(determinant > 0.0)) return std::nullopt;
    line.rate += (s_tt * s_r - s_rt * s_t) / determinant;
    line.start_s += (s_rr * s_t - s_rt * s_r) / determinant;
    if (!std::isfinite(line.start_s) || !(line.rate > 0.0)) return std::nullopt;
  }
  return line;
}

/// Mean of the scans before the start; `unknown` if there are too few.
double zero_before(const estimate::Trace& trace, double start_s, double unknown) {
  double mean = 0.0;
  double n = 0.0;
  for (std::size_t k = 0; k < trace.size() && trace.time_s[k] < start_s - kIdleEndsBefore_s; ++k) {
    if (trace.usable[k] == 0) continue;
    n += 1.0;
    mean += (trace.value[k] - mean) / n;
  }
  return n >= static_cast<double>(kFewestIdle) ? mean : unknown;
}

}  // namespace

std::optional<model::BeltMotion> belt_from_loading(const estimate::Trace& trace, const detect::Fall& first,
                                                   const model::PullSpeed& plan, double gravity_m_per_s2) {
  if (plan.is_constant()) return model::BeltMotion{};
  if (!(first.rise_from < kFromRest * first.peak)) return std::nullopt;
  const Loading loading = loading_of(trace, first);
  if (loading.value.size() < kFewestStartScans || !(loading.slope > 0.0)) return std::nullopt;
  const auto since_s = time_since_start(plan, loading.mean / loading.slope);
  if (!since_s) return std::nullopt;
  Line line{loading.slope / plan.speed_m_per_s(*since_s), loading.mean_s - *since_s};
  double zero = 0.0;
  for (int round = 0; round < 2; ++round) {
    const std::optional<Line> found = fit_loading(loading, plan, zero, line);
    if (!found) return std::nullopt;
    line = *found;
    zero = zero_before(trace, line.start_s, zero);
  }
  const double K = 0.5 * (first.peak + first.trough);
  const double lag_s = 0.5 * plan.speed_m_per_s(plan.pulls().front().start_s) / (K * gravity_m_per_s2);
  return model::BeltMotion{plan, line.start_s - lag_s, trace.time_s[trace.size() - 1]};
}

}  // namespace stickslip::analysis
