#include "core/detect/turning_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/model/slip_waveform.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::detect {

namespace {

struct MedianLine {
  double time_s = 0.0;
  double value = 0.0;
  double slope = 0.0;
};

/// Through points whose value is within [low, high]: the median of the slopes between any two of them, and
/// the median of what that leaves. Right as long as no more than 29 % of them are strays. [Theil 1950; Sen,
/// J. Am. Stat. Assoc. 63:1379–1389, 1968]
std::optional<MedianLine> median_line(std::span<const estimate::CyclePoint> points, double low,
                                      double high) noexcept {
  constexpr std::size_t kMost = 24;  // Of more, so many at equal distances.
  const auto within = [&](const estimate::CyclePoint& point) {
    return point.value >= low && point.value <= high;
  };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(points, within));
  std::array<const estimate::CyclePoint*, kMost> chosen{};
  std::size_t size = 0;
  std::size_t seen = 0;
  for (const estimate::CyclePoint& point : points) {
    if (!within(point)) continue;
    if (seen++ * kMost >= size * std::max(count, kMost) && size < kMost) chosen[size++] = &point;
  }
  std::array<double, kMost*(kMost - 1) / 2> slopes{};
  std::size_t pairs = 0;
  for (std::size_t j = 1; j < size; ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const double slope = (chosen[j]->value - chosen[i]->value) / (chosen[j]->time_s - chosen[i]->time_s);
      // Two points may have one time: nothing is sorted by NaN.
      if (std::isfinite(slope)) slopes[pairs++] = slope;
    }
  }
  if (pairs == 0) return std::nullopt;
  MedianLine line{chosen[0]->time_s, 0.0, signal::median(std::span{slopes}.first(pairs))};
  std::array<double, kMost> levels{};
  for (std::size_t i = 0; i < size; ++i)
    levels[i] = chosen[i]->value - line.slope * (chosen[i]->time_s - line.time_s);
  line.value = signal::median(std::span{levels}.first(size));
  return line;
}

}  // namespace

std::optional<TurningPoint> parabola_vertex(std::span<const estimate::CyclePoint> points, double near_s,
                                            double reach_s, double sign) noexcept {
  constexpr int kFewestPoints = 3;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int count = 0;
  double base = 0.0;
  for (const estimate::CyclePoint& point : estimate::between(points, near_s - reach_s, near_s + reach_s)) {
    const double x = (point.time_s - near_s) / reach_s;
    if (count++ == 0) base = point.value;
    // The mean of x² over the scans of a point.
    const Eigen::Vector3d by{1.0, x, x * x + point.spread_s2 / (reach_s * reach_s)};
    normal += (point.count * by) * by.transpose();
    right += point.count * (point.value - base) * by;
  }
  if (count < kFewestPoints) return std::nullopt;
  // Of three powers of what is at most one: cofactors are exact enough.
  const Eigen::Vector3d c = normal.inverse() * right;
  if (!c.allFinite() || !(sign * c[2] < 0.0)) return std::nullopt;
  const double vertex = -0.5 * c[1] / c[2];
  if (std::abs(vertex) > 1.0) return std::nullopt;
  return TurningPoint{near_s + vertex * reach_s, base + c[0] + 0.5 * c[1] * vertex};
}

std::optional<double> slope_between(std::span<const estimate::CyclePoint> points, double low, double high,
                                    double sigma) noexcept {
  constexpr int kRounds = 3;  // Of reweighting.
  const auto start = median_line(points, low, high);
  if (!start) return std::nullopt;
  auto [mean_t, mean_c, slope] = *start;
  for (int round = 0; round < kRounds; ++round) {
    const double before_t = mean_t;
    const double before_c = mean_c;
    const double before_slope = slope;
    int inside = 0;
    int followed = 0;
    double n = 0.0;
    double s_tt = 0.0;
    double s_tc = 0.0;
    mean_t = mean_c = 0.0;
    for (const estimate::CyclePoint& point : points) {
      if (point.value < low || point.value > high) continue;
      ++inside;
      const double off = point.value - before_c - before_slope * (point.time_s - before_t);
      const double z = off * std::sqrt(point.count) / sigma;
      if (std::abs(z) > estimate::kStraySigmas) continue;
      ++followed;
      const double count = estimate::huber_weight(z) * point.count;
      // Running means: no difference of large sums [Welford, Technometrics 4(3):419–420, 1962].
      n += count;
      const double dt = point.time_s - mean_t;
      mean_t += count / n * dt;
      mean_c += count / n * (point.value - mean_c);
      s_tt += count * dt * (point.time_s - mean_t);
      s_tc += count * dt * (point.value - mean_c);
    }
    // A bent rise has no line that describes it, and the few points that one happens to meet have no say.
    if (2 * followed <= inside || !(s_tt > 0.0)) return start->slope;
    slope = s_tc / s_tt;
  }
  return slope;
}

double K_of_turning_points(double peak, double trough, const model::Oscillator& oscillator) noexcept {
  const double left = std::exp(-std::numbers::pi * oscillator.gamma_over_2omega());
  return (trough + left * peak) / (1.0 + left);
}

SlipOfPeak slip_of_peak(double peak_above_K, double stick_rate_per_s,
                        const model::Oscillator& oscillator) noexcept {
  constexpr int kRounds = 8;             // Of Newton, from [2]; the peak rises with D and is convex in it.
  constexpr double kSettledPart = 1e-5;  // Of itself: the next round would change it by the square.
  const double belt = stick_rate_per_s / oscillator.omega_rad_per_s();
  double D = std::sqrt(std::max(peak_above_K * peak_above_K - belt * belt, 0.0));
  double peak_time_s = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    peak_time_s = model::SlipWaveform{0.0, D, stick_rate_per_s, oscillator}.peak_time_s();
    const model::DampedBasis at = model::damped_basis(oscillator, peak_time_s);
    // At its maximum the course moves with D alone.
    const double by_D = at.cosine + 0.5 * oscillator.gamma_per_s * at.sine;
    if (!(by_D > 0.0)) break;
    const double peak = D * by_D + stick_rate_per_s * at.sine;
    const double before = D;
    D = std::max(D + (peak_above_K - peak) / by_D, 0.0);
    if (std::abs(D - before) <= kSettledPart * D) break;
  }
  // From rest at the peak: c′ = −(ω₀²/ω) (peak − K) e^{−γt/2} sin ωt is least π/2 − φ later [16].
  const double phi = oscillator.phi_rad();
  const double fastest_per_s = std::sqrt(oscillator.omega0_squared()) * peak_above_K *
                               std::exp(-oscillator.gamma_over_2omega() * (0.5 * std::numbers::pi - phi));
  return {D, peak_time_s, fastest_per_s / stick_rate_per_s};
}

}  // namespace stickslip::detect
