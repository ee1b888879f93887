#include "core/daq/load_cell_fit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stickslip::daq {
namespace {

LoadCellFit none(std::string reason, std::size_t used) {
  LoadCellFit fit;
  fit.used = static_cast<int>(used);
  fit.reason = std::move(reason);
  return fit;
}

/// Volts = zero + sensitivity · newtons.
struct Line {
  double zero_V = 0.0;
  double V_per_N = 0.0;

  [[nodiscard]] double off(const LoadPoint& point) const {
    return point.voltage_V - (zero_V + V_per_N * point.force_N);
  }
};

/// Of points whose load grew since the point before, and of those whose load fell.
std::optional<double> hysteresis(std::span<const LoadPoint> points, const Line& line) {
  double rising = 0.0;
  double falling = 0.0;
  double rising_count = 0.0;
  double falling_count = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].force_N > points[i - 1].force_N) {
      rising += line.off(points[i]);
      rising_count += 1.0;
    } else if (points[i].force_N < points[i - 1].force_N) {
      falling += line.off(points[i]);
      falling_count += 1.0;
    }
  }
  if (rising_count == 0.0 || falling_count == 0.0) return std::nullopt;
  return falling / falling_count - rising / rising_count;
}

}  // namespace

LoadCellFit fit_load_cell(std::span<const LoadPoint> points) {
  std::vector<LoadPoint> used;
  std::size_t saturated = 0;
  for (const LoadPoint& point : points) {
    if (!std::isfinite(point.force_N) || !std::isfinite(point.voltage_V)) {
      return none("a load or a voltage is not a number", used.size());
    }
    if (point.saturated) {
      ++saturated;
    } else {
      used.push_back(point);
    }
  }
  const std::string left_out =
      saturated > 0 ? " (" + std::to_string(saturated) + " saturated left out)" : std::string{};
  if (used.empty()) return none("no reading that counts" + left_out, 0);

  const auto n = static_cast<double>(used.size());
  double mean_N = 0.0;
  double mean_V = 0.0;
  double largest_N = 0.0;
  for (const LoadPoint& point : used) {
    mean_N += point.force_N / n;
    mean_V += point.voltage_V / n;
    largest_N = std::max(largest_N, std::abs(point.force_N));
  }
  // About the means, so that a milligram beside ten kilograms keeps its digits.
  double s_NN = 0.0;
  double s_NV = 0.0;
  for (const LoadPoint& point : used) {
    s_NN += (point.force_N - mean_N) * (point.force_N - mean_N);
    s_NV += (point.force_N - mean_N) * (point.voltage_V - mean_V);
  }
  // Equal loads differ by rounding of the mean at the most.
  constexpr double kRounding = 1e-15;
  if (!(std::sqrt(s_NN / n) > kRounding * largest_N)) {
    return none("all loads are equal: gain and zero need two different ones" + left_out, used.size());
  }
  const Line line{mean_V - s_NV / s_NN * mean_N, s_NV / s_NN};
  if (line.V_per_N == 0.0) return none("the voltage does not follow the load" + left_out, used.size());

  LoadCellFit fit;
  fit.used = static_cast<int>(used.size());
  fit.load_cell = LoadCell{1.0 / line.V_per_N, line.zero_V};
  fit.hysteresis_V = hysteresis(used, line);
  if (used.size() < 3) return fit;
  double squares = 0.0;
  for (const LoadPoint& point : used) squares += line.off(point) * line.off(point);
  const double variance = squares / (n - 2.0);
  fit.residual_V = std::sqrt(variance);
  fit.zero_standard_error_V = std::sqrt(variance * (1.0 / n + mean_N * mean_N / s_NN));
  const double sensitivity_error = std::sqrt(variance / s_NN);
  fit.gain_standard_error_N_per_V = sensitivity_error / (line.V_per_N * line.V_per_N);
  // Student's 99.9 % for one degree of freedom would be 637: three standard errors for any number of points,
  // since what is asked is only whether there is a cell at the other end of the wire.
  if (!(std::abs(line.V_per_N) > 3.0 * sensitivity_error)) {
    return none("the voltage does not follow the load" + left_out, used.size());
  }
  return fit;
}

}  // namespace stickslip::daq
