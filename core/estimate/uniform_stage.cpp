#include "core/estimate/uniform_stage.hpp"

#include <algorithm>
#include <cmath>

#include <boost/math/distributions/fisher_f.hpp>

namespace stickslip::estimate {
namespace {

using P = model::UniformParameters;

/// Fewest slips for the comparison.
constexpr std::size_t kFewestSlips = 3;
/// Change of the cost, in units of log-likelihood, at which the slips' own fit is good enough for a
/// comparison of costs: it moves F by less than 1 % of its standard deviation.
constexpr double kEnough = 0.01;
/// Newton steps of the first guess by its period; few suffice, since the period is nearly linear over the
/// standard errors of the parameters.
constexpr int kPeriodSteps = 4;

/// Onsets against the number of the cycle: a straight line.
struct Onsets {
  double first_s = 0.0;
  double period_s = 0.0;
};

/// \param period_s  roughly; a slip that a gap has swallowed still counts.
Onsets regular_onsets(const std::vector<SlipWindow>& windows, double period_s) {
  double mean_i = 0.0;
  double mean_t = 0.0;
  const auto n = static_cast<double>(windows.size());
  const double origin_s = windows.front().slip.onset_s;
  const auto cycle = [&](const SlipWindow& window) {
    return std::round((window.slip.onset_s - origin_s) / period_s);
  };
  for (const SlipWindow& window : windows) {
    mean_i += cycle(window) / n;
    mean_t += (window.slip.onset_s - origin_s) / n;
  }
  double s_ii = 0.0;
  double s_it = 0.0;
  for (const SlipWindow& window : windows) {
    s_ii += (cycle(window) - mean_i) * (cycle(window) - mean_i);
    s_it += (cycle(window) - mean_i) * (window.slip.onset_s - origin_s - mean_t);
  }
  const double slope = s_ii > 0.0 ? s_it / s_ii : period_s;
  return {origin_s + mean_t - slope * mean_i, slope};
}

/// Means over the slips, moved as little as their covariance allows so that the course has the period seen.
/// Without it a course of hundreds of slips would begin a cycle off at its far end.
std::optional<P> first_guess(const std::vector<SlipWindow>& windows, const SlipFit& fit) {
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
  P guess{fit.shared, {windows.front().slip.onset_s, 0.0, 0.0}};
  const auto n = static_cast<double>(windows.size());
  for (const SlipWindow& window : windows) {
    guess.slip.S += window.slip.S / n;
    guess.slip.K += window.slip.K / n;
    own += window.inverse_curvature / (n * n);
    coupling += window.coupling / n;
  }
  P::Matrix covariance = P::Matrix::Zero();
  covariance.topLeftCorner<3, 3>() = own + coupling * fit.shared_covariance * coupling.transpose();
  covariance.topRightCorner<3, 3>() = -coupling * fit.shared_covariance;
  covariance.bottomLeftCorner<3, 3>() = covariance.topRightCorner<3, 3>().transpose();
  covariance.bottomRightCorner<3, 3>() = fit.shared_covariance;
  for (int step = 0; step < kPeriodSteps; ++step) {
    const auto course = model::UniformTrajectory::make(guess);
    if (!course) return std::nullopt;
    const Onsets onsets = regular_onsets(windows, course->period_s());
    const P::Vector pull = covariance * course->period_slope();
    const double leverage = course->period_slope().dot(pull);
    if (!(leverage > 0.0)) return std::nullopt;
    P::Vector p = guess.vector() + pull * ((onsets.period_s - course->period_s()) / leverage);
    p[P::kOnset] = onsets.first_s;
    guess = P::from(p);
  }
  return model::UniformTrajectory::make(guess) ? std::optional{guess} : std::nullopt;
}

/// Probability of a difference at least this large if the slips are alike.
double probability_alike(const SlipFit& each, const UniformFit& uniform, std::size_t slips) {
  const double parameters = 3.0 * static_cast<double>(slips) - 3.0;
  const double F = 2.0 * (uniform.cost - each.cost) / each.cost_scale / parameters;
  if (!std::isfinite(F)) return 0.0;
  if (F <= 0.0) return 1.0;
  const boost::math::fisher_f_distribution<double> expected{parameters, each.freedom};
  return boost::math::cdf(boost::math::complement(expected, F));
}

}  // namespace

std::optional<UniformFit> uniform_if_slips_agree(const Trace& trace, const std::vector<SlipWindow>& windows,
                                                 const model::SharedParameters& shared, double sigma,
                                                 const SharedPrior& prior, bool first_counts) {
  const bool regular =
      windows.size() >= kFewestSlips &&
      std::all_of(windows.begin(), windows.end(), [](const SlipWindow& w) { return w.captured; });
  if (!regular) return std::nullopt;
  std::vector<SlipWindow> slips{windows.begin() + (first_counts ? 0 : 1), windows.end()};
  const SlipFit each = fit_slips(trace, slips, shared, sigma, prior, kEnough);
  if (!each.converged || !(each.freedom > 0.0)) return std::nullopt;
  const std::optional<P> guess = first_guess(slips, each);
  if (!guess) return std::nullopt;
  UniformFit uniform = fit_uniform(trace, slips.front().first, slips.back().end, *guess, sigma, prior);
  if (!uniform.converged || probability_alike(each, uniform, slips.size()) < kScatterLevel)
    return std::nullopt;
  return uniform;
}

}  // namespace stickslip::estimate
