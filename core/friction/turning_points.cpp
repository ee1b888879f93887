#include "core/friction/turning_points.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/friction/huber.hpp"
#include "core/friction/slip_waveform.hpp"

namespace stickslip::friction {

std::optional<TurningPoint> parabola_vertex(std::span<const CyclePoint> points, double near_s, double reach_s,
                                            double sign) noexcept {
  constexpr int kFewestPoints = 3;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int count = 0;
  double base = 0.0;
  for (const CyclePoint& point : points) {
    const double x = (point.time_s - near_s) / reach_s;
    if (std::abs(x) > 1.0) continue;
    if (count++ == 0) base = point.value;
    // The mean of x² over the scans of a point.
    const Eigen::Vector3d by{1.0, x, x * x + point.spread_s2 / (reach_s * reach_s)};
    normal += (point.count * by) * by.transpose();
    right += point.count * (point.value - base) * by;
  }
  if (count < kFewestPoints) return std::nullopt;
  const Eigen::Vector3d c = normal.ldlt().solve(right);
  if (!c.allFinite() || !(sign * c[2] < 0.0)) return std::nullopt;
  const double vertex = -0.5 * c[1] / c[2];
  if (std::abs(vertex) > 1.0) return std::nullopt;
  return TurningPoint{near_s + vertex * reach_s, base + c[0] + 0.5 * c[1] * vertex};
}

std::optional<double> slope_between(std::span<const CyclePoint> points, double low, double high,
                                    double sigma) noexcept {
  constexpr int kRounds = 4;  // Of reweighting; the first is least squares.
  double mean_t = 0.0;
  double mean_c = 0.0;
  double slope = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const double before_t = mean_t;
    const double before_c = mean_c;
    const double before_slope = slope;
    double n = 0.0;
    double s_tt = 0.0;
    double s_tc = 0.0;
    mean_t = mean_c = 0.0;
    for (const CyclePoint& point : points) {
      if (point.value < low || point.value > high) continue;
      const double off = point.value - before_c - before_slope * (point.time_s - before_t);
      const double weight = round == 0 ? 1.0 : huber_weight(off * std::sqrt(point.count) / sigma);
      const double count = weight * point.count;
      // Running means: no difference of large sums [Welford, Technometrics 4(3):419–420, 1962].
      n += count;
      const double dt = point.time_s - mean_t;
      mean_t += count / n * dt;
      mean_c += count / n * (point.value - mean_c);
      s_tt += count * dt * (point.time_s - mean_t);
      s_tc += count * dt * (point.value - mean_c);
    }
    if (!(s_tt > 0.0)) return std::nullopt;
    slope = s_tc / s_tt;
  }
  return slope;
}

double K_of_turning_points(double peak, double trough, const Oscillator& oscillator) noexcept {
  const double left = std::exp(-std::numbers::pi * oscillator.gamma_over_2omega());
  return (trough + left * peak) / (1.0 + left);
}

double delta_mu_of_peak(double peak_above_K, double stick_rate_per_s, const Oscillator& oscillator) noexcept {
  constexpr int kRounds = 8;  // Of Newton, from [2]; the peak rises with D and is convex in it.
  const double belt = stick_rate_per_s / oscillator.omega_rad_per_s();
  double D = std::sqrt(std::max(peak_above_K * peak_above_K - belt * belt, 0.0));
  for (int round = 0; round < kRounds; ++round) {
    const SlipWaveform slip{0.0, D, stick_rate_per_s, oscillator};
    const DampedBasis at = damped_basis(oscillator, slip.peak_time_s());
    // At its maximum the course moves with D alone.
    const double by_D = at.cosine + 0.5 * oscillator.gamma_per_s * at.sine;
    if (!(by_D > 0.0)) break;
    const double peak = D * by_D + stick_rate_per_s * at.sine;
    const double before = D;
    D = std::max(D + (peak_above_K - peak) / by_D, 0.0);
    if (D == before) break;
  }
  return D;
}

}  // namespace stickslip::friction
