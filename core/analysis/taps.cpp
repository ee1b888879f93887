#include "core/analysis/taps.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/minimise.hpp"
#include "core/signal/noise.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Standard deviations of the noise by which a reading of a tap is off the level.
constexpr double kTapSigmas = 12.0;
/// Time below that which ends a tap: half a period of the slowest cell.
constexpr double kQuiet_s = 0.15;
/// Readings a second beyond which neighbours are averaged: it leaves frequency and damping as they are.
constexpr double kHighestRate_Hz = 4000.0;
/// Fewest readings of a fit: as many for the residuals as parameters.
constexpr std::size_t kFewestScans = 12;
/// Most readings from the largest one on in which a fit may begin.
constexpr std::size_t kMostScans = 1024;
/// Standard errors of the variance of the residuals up to which they are noise, and no later beginning of the
/// fit is tried: a larger limit would let in what swings beside the cell. Of fits that all leave more, the
/// one that leaves least counts up to kMostErrors.
constexpr double kNoiseErrors = 1.0;
constexpr double kMostErrors = 3.0;
/// Least amplitude where a fit begins, in standard deviations of the noise.
constexpr double kLowestSigmas = 6.0;
/// Fewest oscillations until the noise hides them: fewer may be the end of a push.
constexpr double kFewestOscillations = 1.5;
/// Eighths of a period by which the fit begins later than where its residuals are noise.
constexpr std::size_t kLater = 4;
/// Relative standard error of ω above which a tap tells no frequency.
constexpr double kVague = 0.05;
/// Of a first guess: steps of the frequency for each period that the readings span, and values of γ/2ω.
constexpr double kGuessesPerPeriod = 4.0;
constexpr double kDampings[] = {0.003, 0.01, 0.03, 0.1, 0.3};

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// (level, its slope, of the cosine, of the sine, ω, γ/2); times in scans.
using RingState = Vector6d;

struct RingEquations {
  Matrix6d normal = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  estimate::HuberSums sums;
  double cost = std::numeric_limits<double>::infinity();
};

/// level + slope t + e^(−γt/2) (a cos ωt + b sin ωt). For minimise().
struct RingProblem {
  using State = RingState;
  using Equations = RingEquations;

  std::span<const double> values;
  double sigma;

  void assemble(const State& at, Equations& equations) const {
    equations = {};
    if (!at.allFinite() || !(at[4] > 0.0) || !(at[4] < std::numbers::pi) || !(at[5] > 0.0)) return;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto t = static_cast<double>(k);
      const std::complex<double> wave = std::exp(std::complex<double>{-at[5] * t, at[4] * t});
      const double swing = at[2] * wave.real() + at[3] * wave.imag();
      Vector6d by;
      by << 1.0, t, wave.real(), wave.imag(), t * (at[3] * wave.real() - at[2] * wave.imag()), -t * swing;
      const double z = (values[k] - at[0] - at[1] * t - swing) / sigma;
      const double weight = equations.sums.add(z);
      equations.normal.noalias() += weight / (sigma * sigma) * by * by.transpose();
      equations.gradient += weight * z / sigma * by;
    }
    equations.cost = equations.sums.cost();
  }

  [[nodiscard]] double step(const State& from, const Equations& equations, double damping, State& to) const {
    Matrix6d normal = equations.normal;
    normal.diagonal() *= 1.0 + damping;
    const Vector6d unit =
        normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
    const Matrix6d scaled = unit.asDiagonal() * normal * unit.asDiagonal();
    const Vector6d step = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(equations.gradient)));
    to = from + step;
    return 0.5 * step.dot(equations.gradient);
  }
};

/// Level, its slope and amplitudes of least squares for this ω and γ/2, and the sum of squares that they
/// leave.
std::pair<RingState, double> best_with(std::span<const double> values, double omega, double half_gamma) {
  const std::complex<double> turn = std::exp(std::complex<double>{-half_gamma, omega});
  std::complex<double> wave{1.0, 0.0};
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double squares = 0.0;
  double t = 0.0;
  for (const double value : values) {
    const Eigen::Vector4d by{1.0, t, wave.real(), wave.imag()};
    t += 1.0;
    normal.noalias() += by * by.transpose();
    right += value * by;
    squares += value * value;
    wave *= turn;
  }
  const Eigen::Vector4d found = normal.ldlt().solve(right);
  RingState state;
  state << found, omega, half_gamma;
  return {state, squares - found.dot(right)};
}

RingState first_guess(std::span<const double> values) {
  std::pair<RingState, double> best{RingState::Zero(), std::numeric_limits<double>::infinity()};
  const double step = 2.0 * std::numbers::pi / kGuessesPerPeriod / static_cast<double>(values.size());
  for (double omega = kGuessesPerPeriod * step; omega < std::numbers::pi; omega += step) {
    for (const double gamma_over_2omega : kDampings) {
      const auto tried = best_with(values, omega, gamma_over_2omega * omega);
      if (tried.second < best.second) best = tried;
    }
  }
  return best.first;
}

/// Noise of a reading, and how many readings tell it.
struct Noise {
  double sigma = 0.0;
  double scans = 0.0;
};

struct RingFit {
  RingState state;
  Matrix6d covariance;
  double excess = 0.0;  ///< Of the variance of the residuals over that of noise, in its standard errors.

  /// Whether it is an oscillation, and seen for long enough.
  [[nodiscard]] bool swings(double sigma) const {
    const double height = std::hypot(state[2], state[3]) / sigma;
    const double seen = std::log(height) / (2.0 * std::numbers::pi * state[5] / state[4]);
    return height >= kLowestSigmas && seen >= kFewestOscillations;
  }
};

std::optional<RingFit> fit_ring(std::span<const double> values, const Noise& noise, const RingState& guess) {
  if (values.size() < kFewestScans) return std::nullopt;
  const RingProblem problem{values, noise.sigma};
  RingFit fit{best_with(values, guess[4], guess[5]).first, {}, 0.0};
  RingEquations equations;
  problem.assemble(fit.state, equations);
  constexpr int kRingIterations = 60;
  constexpr double kRingSettled = 1e-6;
  if (!estimate::minimise(problem, fit.state, equations,
                          {.iterations = kRingIterations, .absolute = kRingSettled}))
    return std::nullopt;
  constexpr double kRingParameters = 6.0;
  fit.covariance = equations.sums.covariance_scale(kRingParameters) * equations.normal.inverse();
  if (!fit.covariance.allFinite() || !(fit.covariance.diagonal().minCoeff() > 0.0)) return std::nullopt;
  const double ratio = equations.sums.residual_sigma(kRingParameters) / estimate::kHuberResidualOfNoise;
  fit.excess =
      (ratio * ratio - 1.0) / std::sqrt(2.0 / (equations.sums.count() - kRingParameters) + 2.0 / noise.scans);
  return fit;
}

/// Readings [first, end) of one tap, the largest at `peak`.
struct Knock {
  std::size_t first = 0;
  std::size_t peak = 0;
  std::size_t last = 0;  ///< The last one above the threshold.
  std::size_t end = 0;
};

/// Level of the readings outside taps, which may drift.
class RunningLevel {
 public:
  /// \param memory  readings. The level begins as the median of the first so many.
  RunningLevel(std::span<const double> values, std::size_t memory) : memory_(static_cast<double>(memory)) {
    const std::span<const double> begin = values.first(std::min(memory, values.size()));
    std::vector<double> sorted{begin.begin(), begin.end()};
    value_ = signal::median(sorted);
  }
  [[nodiscard]] double value() const noexcept { return value_; }
  void add(double reading) noexcept { value_ += (reading - value_) / memory_; }

 private:
  double memory_;
  double value_ = 0.0;
};

/// \param quiet  readings below the threshold that end a tap.
std::vector<Knock> knocks_in(std::span<const double> values, double threshold, std::size_t quiet) {
  RunningLevel level{values, quiet};
  std::vector<Knock> knocks;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = std::abs(values[k] - level.value());
    const bool is_quiet = knocks.empty() || k > knocks.back().last + quiet;
    if (!(off > threshold)) {
      if (is_quiet) level.add(values[k]);
      continue;
    }
    if (is_quiet) {
      if (!knocks.empty()) knocks.back().end = k;
      knocks.push_back({k, k, k, values.size()});
    }
    Knock& knock = knocks.back();
    knock.last = k;
    if (off > std::abs(values[knock.peak] - level.value())) knock.peak = k;
  }
  for (Knock& knock : knocks) {
    knock.last = std::min(knock.last, knock.peak + kMostScans);
    // As long again as it is seen: there is the rest of it, and the level.
    knock.end = std::min(knock.end, knock.last + (knock.last - knock.peak) + quiet);
  }
  return knocks;
}

/// About the noise of a reading, whatever taps there are: that of the quieter quarter of its blocks.
double rough_noise(std::span<const double> values) {
  const double rounding = signal::smallest_step(values) / std::sqrt(12.0);
  signal::FourthDifferences differences;
  std::vector<double> medians;
  for (const double value : values) {
    if (differences.add(value))
      medians.push_back(signal::block_median(differences.block(), medians.empty() ? 0.0 : medians.back()));
  }
  if (medians.empty()) return rounding;
  const auto at = medians.begin() + static_cast<std::ptrdiff_t>(medians.size() / 4);
  std::ranges::nth_element(medians, at);
  return std::max(rounding, signal::sigma_of_median(*at));
}

/// The noise outside the taps, by the measure that tells the residuals of a fit, whatever its distribution
/// and its spectrum are.
Noise noise_outside(std::span<const double> values, const std::vector<Knock>& knocks, std::size_t quiet,
                    double rough_sigma) {
  std::vector<double> off;
  signal::RunningVariance spread;
  RunningLevel level{values, quiet};
  auto next = knocks.begin();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (next != knocks.end() && k == next->first) {
      k = next->end - 1;
      ++next;
      continue;
    }
    off.push_back(values[k] - level.value());
    spread.add(off.back());
    level.add(values[k]);
  }
  const double sigma = std::max(std::sqrt(spread.variance()), rough_sigma);
  estimate::HuberSums sums;
  for (const double one : off) sums.add((one - spread.mean) / sigma);
  const double measured = sigma * sums.residual_sigma(1.0) / estimate::kHuberResidualOfNoise;
  return {std::max(measured, rough_sigma), std::max(static_cast<double>(off.size()), 1.0)};
}

/// Means of so many neighbours each.
std::vector<double> averaged(std::span<const double> values, std::size_t count) {
  std::vector<double> means;
  for (std::size_t k = 0; k + count <= values.size(); k += count) {
    const std::span<const double> own = values.subspan(k, count);
    means.push_back(std::accumulate(own.begin(), own.end(), 0.0) / static_cast<double>(count));
  }
  return means;
}

TesterEstimate ring_of(const RingFit& fit, double scan_rate_Hz) {
  const double omega = fit.state[4] * scan_rate_Hz;
  const double gamma = 2.0 * fit.state[5] * scan_rate_Hz;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  const Eigen::Vector2d scale{scan_rate_Hz, 2.0 * scan_rate_Hz};
  covariance.topLeftCorner<2, 2>() =
      scale.asDiagonal() * fit.covariance.bottomRightCorner<2, 2>() * scale.asDiagonal();
  return TesterEstimate::from({omega, gamma, 0.0}, covariance);
}

}  // namespace

Taps find_taps(std::span<const double> readings, double scan_rate_Hz) {
  const auto together = static_cast<std::size_t>(std::max(std::floor(scan_rate_Hz / kHighestRate_Hz), 1.0));
  const std::vector<double> means = together > 1 ? averaged(readings, together) : std::vector<double>{};
  const std::span<const double> values = together > 1 ? std::span{means} : readings;
  const double rate_Hz = scan_rate_Hz / static_cast<double>(together);
  Taps found;
  if (values.size() < kFewestScans) return found;
  const auto quiet = static_cast<std::size_t>(std::ceil(kQuiet_s * rate_Hz));
  const double rough_sigma = rough_noise(values);
  const std::vector<Knock> knocks = knocks_in(values, kTapSigmas * rough_sigma, quiet);
  const Noise noise = noise_outside(values, knocks, quiet, rough_sigma);
  for (const Knock& knock : knocks) {
    const double at_s = static_cast<double>(knock.peak) / rate_Hz;
    const auto from = [&](std::size_t first) { return values.subspan(first, knock.end - first); };
    const RingState guess = first_guess(from(knock.peak + (knock.last - knock.peak) / 2));
    // The contact may last beyond the peak: the fit begins later, until its residuals are noise.
    const double eighth = guess[4] > 0.0 ? std::numbers::pi / 4.0 / guess[4] : 1.0;
    const auto step = static_cast<std::size_t>(std::max(eighth, 1.0));
    std::optional<RingFit> fit;
    for (std::size_t first = knock.peak; first <= knock.last; first += step) {
      const std::optional<RingFit> one = fit_ring(from(first), noise, guess);
      if (!one || !one->swings(noise.sigma)) continue;
      if (!fit || one->excess < fit->excess) fit = one;
      if (fit->excess > kNoiseErrors) continue;
      // What is left of the contact is below the noise now, and still shifts the fit.
      const std::optional<RingFit> later =
          fit_ring(from(std::min(first + kLater * step, knock.last)), noise, guess);
      if (later && later->swings(noise.sigma)) fit = later;
      break;
    }
    if (!fit || fit->excess > kMostErrors) {
      found.refused.push_back(
          {at_s, "what follows is not one decaying oscillation; tap once, with something hard"});
    } else if (std::sqrt(fit->covariance(4, 4)) > kVague * fit->state[4]) {
      found.refused.push_back(
          {at_s, "too little is seen of the oscillation; tap harder, or take more scans a second"});
    } else {
      found.taps.push_back({at_s, ring_of(*fit, rate_Hz)});
    }
  }
  return found;
}

CellEstimate cell_of(const estimate::SharedPrior::Coupling& coupling) {
  const double g = coupling.gamma_over_2omega;
  const double root = std::sqrt(1.0 + g * g);
  const auto error = [&](double by_omega, double by_g) {
    const Eigen::Vector2d by{by_omega, by_g};
    return std::sqrt(by.dot(coupling.covariance * by));
  };
  constexpr double kTurn = 2.0 * std::numbers::pi;
  return {Estimate::of(coupling.omega * root / kTurn, error(root / kTurn, coupling.omega * g / root / kTurn)),
          Estimate::of(g / root, error(0.0, 1.0 / (root * root * root)))};
}

}  // namespace stickslip::analysis
