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
/// Fewest readings of a fit: as many for the residuals as parameters, and more.
constexpr std::size_t kFewestScans = 12;
/// Most readings from the largest one on in which a fit may begin.
constexpr std::size_t kMostScans = 1024;
/// Standard errors of the variance of the residuals up to which they count as noise. One fit in six of noise
/// alone exceeds it, and the next one begins later. A larger limit would let in what swings beside the cell.
constexpr double kNoiseErrors = 1.0;
/// Fewest oscillations until the noise hides them: fewer may be the end of a push.
constexpr double kFewestOscillations = 1.5;
/// Relative standard error of ω above which a tap tells no frequency.
constexpr double kVague = 0.05;
/// Of a first guess: steps of the frequency for each period that the readings span, and values of γ/2ω.
constexpr double kGuessesPerPeriod = 4.0;
constexpr double kDampings[] = {0.003, 0.01, 0.03, 0.1, 0.3};

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// (level, of the cosine, of the sine, ω, γ/2); times in scans.
using RingState = Vector5d;

struct RingEquations {
  Matrix5d normal = Matrix5d::Zero();
  Vector5d gradient = Vector5d::Zero();
  estimate::HuberSums sums;
  double cost = std::numeric_limits<double>::infinity();
};

/// level + e^(−γt/2) (a cos ωt + b sin ωt). For minimise().
struct RingProblem {
  using State = RingState;
  using Equations = RingEquations;

  std::span<const double> values;
  double sigma;

  void assemble(const State& at, Equations& equations) const {
    equations = {};
    if (!at.allFinite() || !(at[3] > 0.0) || !(at[3] < std::numbers::pi) || !(at[4] > 0.0)) return;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const auto t = static_cast<double>(k);
      const std::complex<double> wave = std::exp(std::complex<double>{-at[4] * t, at[3] * t});
      const double swing = at[1] * wave.real() + at[2] * wave.imag();
      Vector5d by;
      by << 1.0, wave.real(), wave.imag(), t * (at[2] * wave.real() - at[1] * wave.imag()), -t * swing;
      const double z = (values[k] - at[0] - swing) / sigma;
      const double weight = equations.sums.add(z);
      equations.normal.noalias() += weight / (sigma * sigma) * by * by.transpose();
      equations.gradient += weight * z / sigma * by;
    }
    equations.cost = equations.sums.cost();
  }

  [[nodiscard]] double step(const State& from, const Equations& equations, double damping, State& to) const {
    Matrix5d normal = equations.normal;
    normal.diagonal() *= 1.0 + damping;
    const Vector5d unit =
        normal.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
    const Matrix5d scaled = unit.asDiagonal() * normal * unit.asDiagonal();
    const Vector5d step = unit.cwiseProduct(scaled.ldlt().solve(unit.cwiseProduct(equations.gradient)));
    to = from + step;
    return 0.5 * step.dot(equations.gradient);
  }
};

/// Level and amplitudes of least squares for this ω and γ/2, and the sum of squares that they leave.
std::pair<RingState, double> best_with(std::span<const double> values, double omega, double half_gamma) {
  const std::complex<double> turn = std::exp(std::complex<double>{-half_gamma, omega});
  std::complex<double> wave{1.0, 0.0};
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double squares = 0.0;
  for (const double value : values) {
    const Eigen::Vector3d by{1.0, wave.real(), wave.imag()};
    normal.noalias() += by * by.transpose();
    right += value * by;
    squares += value * value;
    wave *= turn;
  }
  const Eigen::Vector3d found = normal.ldlt().solve(right);
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

struct RingFit {
  RingState state;
  Matrix5d covariance;
  double excess = 0.0;  ///< Of the variance of the residuals over that of noise, in its standard errors.

  /// Whether it is an oscillation that leaves no more than noise.
  [[nodiscard]] bool describes(double sigma) const {
    const double seen =
        std::log(std::hypot(state[1], state[2]) / sigma) / (2.0 * std::numbers::pi * state[4] / state[3]);
    return excess <= kNoiseErrors && seen >= kFewestOscillations;
  }
};

std::optional<RingFit> fit_ring(std::span<const double> values, double sigma, const RingState& guess) {
  if (values.size() < kFewestScans) return std::nullopt;
  const RingProblem problem{values, sigma};
  RingFit fit{best_with(values, guess[3], guess[4]).first, {}, 0.0};
  RingEquations equations;
  problem.assemble(fit.state, equations);
  constexpr int kIterations = 60;
  constexpr double kSettled = 1e-6;
  if (!estimate::minimise(problem, fit.state, equations, {.iterations = kIterations, .absolute = kSettled}))
    return std::nullopt;
  constexpr double kParameters = 5.0;
  fit.covariance = equations.sums.covariance_scale(kParameters) * equations.normal.inverse();
  if (!fit.covariance.allFinite() || !(fit.covariance.diagonal().minCoeff() > 0.0)) return std::nullopt;
  const double ratio = equations.sums.residual_sigma(kParameters) / estimate::kHuberResidualOfNoise;
  fit.excess = (ratio * ratio - 1.0) * std::sqrt(0.5 * (equations.sums.count() - kParameters));
  return fit;
}

/// Readings [first, end) of one tap, the largest at `peak`.
struct Knock {
  std::size_t first = 0;
  std::size_t peak = 0;
  std::size_t last = 0;  ///< The last one above the threshold.
  std::size_t end = 0;
};

/// \param quiet  readings below the threshold that end a tap.
std::vector<Knock> knocks_in(std::span<const double> values, double threshold, std::size_t quiet) {
  std::vector<double> first{values.begin(),
                            values.begin() + static_cast<std::ptrdiff_t>(std::min(quiet, values.size()))};
  double level = signal::median(first);  // Before the tap: it may drift.
  std::vector<Knock> knocks;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double off = std::abs(values[k] - level);
    const bool is_quiet = knocks.empty() || k > knocks.back().last + quiet;
    if (!(off > threshold)) {
      if (is_quiet) level += (values[k] - level) / static_cast<double>(quiet);
      continue;
    }
    if (is_quiet) {
      if (!knocks.empty()) knocks.back().end = k;
      knocks.push_back({k, k, k, values.size()});
    }
    Knock& knock = knocks.back();
    knock.last = k;
    if (off > std::abs(values[knock.peak] - level)) knock.peak = k;
  }
  for (Knock& knock : knocks) {
    knock.last = std::min(knock.last, knock.peak + kMostScans);
    // As long again as it is seen: there is the rest of it, and the level.
    knock.end = std::min(knock.end, knock.last + (knock.last - knock.peak) + quiet);
  }
  return knocks;
}

/// Noise of a reading outside the taps, at least the floor.
/// \param share  of the blocks of readings that have less noise.
double noise_outside(std::span<const double> values, const std::vector<Knock>& knocks, double share,
                     double floor) {
  signal::FourthDifferences differences;
  std::vector<double> medians;
  auto next = knocks.begin();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (next != knocks.end() && k == next->first) {
      differences.gap();
      k = next->end - 1;
      ++next;
    } else if (differences.add(values[k])) {
      medians.push_back(signal::block_median(differences.block(), medians.empty() ? 0.0 : medians.back()));
    }
  }
  if (medians.empty()) return floor;
  const auto at = medians.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(medians.size()));
  std::ranges::nth_element(medians, at);
  return std::max(floor, signal::sigma_of_median(*at));
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
  const double omega = fit.state[3] * scan_rate_Hz;
  const double gamma = 2.0 * fit.state[4] * scan_rate_Hz;
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
  // The first quarter of the blocks knows of no tap; then those outside them tell the noise.
  const double rounding = signal::smallest_step(values) / std::sqrt(12.0);
  const auto quiet = static_cast<std::size_t>(std::ceil(kQuiet_s * rate_Hz));
  const double roughly = noise_outside(values, {}, 0.25, rounding);
  const std::vector<Knock> knocks = knocks_in(values, kTapSigmas * roughly, quiet);
  const double sigma = std::max(roughly, noise_outside(values, knocks, 0.5, rounding));
  for (const Knock& knock : knocks) {
    const double at_s = static_cast<double>(knock.peak) / rate_Hz;
    const auto from = [&](std::size_t first) { return values.subspan(first, knock.end - first); };
    const RingState guess = first_guess(from(knock.peak + (knock.last - knock.peak) / 2));
    // The contact may last beyond the peak: the fit begins later, until its residuals are noise.
    const auto step = static_cast<std::size_t>(std::max(std::numbers::pi / 4.0 / guess[3], 1.0));
    std::optional<RingFit> fit;
    for (std::size_t first = knock.peak; first <= knock.last; first += step) {
      fit = fit_ring(from(first), sigma, guess);
      if (fit && fit->describes(sigma)) break;
    }
    if (!fit || !fit->describes(sigma)) {
      found.refused.push_back(
          {at_s, "what follows is not one decaying oscillation; tap once, with something hard"});
    } else if (std::sqrt(fit->covariance(3, 3)) > kVague * fit->state[3]) {
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
