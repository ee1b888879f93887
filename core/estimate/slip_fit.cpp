#include "core/estimate/slip_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/estimate/huber.hpp"
#include "core/estimate/minimise.hpp"
#include "core/estimate/slip_sums.hpp"

namespace stickslip::estimate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Limit of the iterations; a dozen nearly always suffices.
constexpr int kMostFitIterations = 60;
/// Limit of the iterations with a prior. A pull speed known to 1e-6 gives the cost a narrow, curved valley,
/// along which some fits need a hundred iterations.
constexpr int kMostFitIterationsWithPrior = 200;
/// Relative change of the cost below which the fit has converged.
constexpr double kFitConverged = 1e-10;

/// Normal equations of one slip; their capture is the first guess of the next.
struct SlipBlock {
  Matrix3d own = Matrix3d::Zero();
  Matrix3d mixed = Matrix3d::Zero();  ///< own × shared
  Vector3d gradient = Vector3d::Zero();
  double capture_s = 0.0;  ///< After the onset; infinity if not captured.
};

struct NormalEquations {
  std::vector<SlipBlock> slips;
  Matrix3d shared = Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  HuberSums sums;     ///< Of the residuals over σ.
  double cost = 0.0;  ///< Of scans and prior.
  PriorTerms prior;
};

Matrix3d damped(const Matrix3d& matrix, double damping) {
  Matrix3d result = matrix;
  result.diagonal() *= 1.0 + damping;
  return result;
}

/// Whether the shared parameters are physical: ω > 0, r > 0 and |γ| < 2ω.
bool admissible(const model::SharedParameters& shared) {
  return std::isfinite(shared.omega) && shared.omega > 0.0 && shared.r > 0.0 &&
         std::abs(shared.gamma) < 2.0 * shared.omega;
}

/// Whether each S − K is at least −6σ, as noise allows. The cost has a second minimum with S far below K,
/// which a step could reach: there the free oscillation meets the line of the stick half a period before the
/// onset.
bool admissible(const std::vector<model::SlipParameters>& slips, double sigma) {
  constexpr double kLowestFitSigmas = 6.0;  // Half of detect::SlipRule::kSignificantSigmas.
  return std::all_of(slips.begin(), slips.end(), [&](const model::SlipParameters& slip) {
    return slip.S - slip.K >= -kLowestFitSigmas * sigma;
  });
}

struct FitState {
  model::SharedParameters shared;
  std::vector<model::SlipParameters> slips;
};

/// Scans of all slips. For minimise().
class SlipsProblem {
 public:
  using State = FitState;
  using Equations = NormalEquations;

  SlipsProblem(const Trace& trace, const std::vector<SlipWindow>& windows, double sigma,
               const SharedPrior& prior)
      : belt_(trace.belt), windows_(windows), sigma_(sigma), prior_(prior) {
    for (const SlipWindow& window : windows) {
      append_usable(trace, window.first, window.end, scans_);
      ends_.push_back(scans_.size());
    }
  }

  void assemble(const State& at, Equations& equations) const {
    equations.cost = std::numeric_limits<double>::infinity();
    if (!admissible(at.shared) || !admissible(at.slips, sigma_)) return;
    const bool first = equations.slips.empty();
    equations.slips.resize(windows_.size());
    equations.shared.setZero();
    equations.gradient.setZero();
    equations.sums = {};
    model::TurnedBasis basis{at.shared.oscillator()};
    for (std::size_t i = 0, begin = 0; i < windows_.size(); begin = ends_[i++]) {
      SlipBlock& block = equations.slips[i];
      const auto expected = first ? std::nullopt : std::optional{block.capture_s};
      const model::SlipModel model{at.shared, at.slips[i], windows_[i].captured, belt_, expected};
      add_scans(std::span{scans_}.subspan(begin, ends_[i] - begin), model, basis, block, equations);
    }
    equations.prior = prior_.at(at.shared);
    // The equations of the scans are in units of σ².
    equations.gradient += sigma_ * sigma_ * equations.prior.gradient;
    equations.cost = equations.sums.cost() + equations.prior.cost;
  }

  /// Each slip's 3 × 3 block is eliminated first (Schur complement).
  [[nodiscard]] double step(const State& from, const Equations& equations, double damping, State& to) const {
    // Only what the scans say is damped: a step along what the prior holds fixed must stay easy.
    Matrix3d reduced = damped(equations.shared, damping) + sigma_ * sigma_ * equations.prior.information;
    Vector3d right = equations.gradient;
    inverses_.clear();
    for (const SlipBlock& block : equations.slips) {
      inverses_.emplace_back(damped(block.own, damping).inverse());
      const Matrix3d eliminated = block.mixed.transpose() * inverses_.back();
      reduced -= eliminated * block.mixed;
      right -= eliminated * block.gradient;
    }
    const Vector3d shared = reduced.ldlt().solve(right);
    to.shared = {from.shared.omega + shared[0], from.shared.gamma + shared[1], from.shared.r + shared[2]};
    to.slips.resize(from.slips.size());
    double gain = shared.dot(equations.gradient);
    for (std::size_t i = 0; i < from.slips.size(); ++i) {
      const SlipBlock& block = equations.slips[i];
      const Vector3d own = inverses_[i] * (block.gradient - block.mixed * shared);
      gain += own.dot(block.gradient);
      const model::SlipParameters& slip = from.slips[i];
      to.slips[i] = {slip.onset_s + own[0], slip.S + own[1], slip.K + own[2]};
    }
    return 0.5 * gain / (sigma_ * sigma_);
  }

 private:
  void add_scans(std::span<const TraceScan> scans, const model::SlipModel& model, model::TurnedBasis& basis,
                 SlipBlock& block, Equations& equations) const {
    SlipSums sums;
    const double per_sigma = 1.0 / sigma_;
    for (const TraceScan& scan : scans) {
      const model::SlipPlace at = model.place(scan.time_s, basis);
      const double residual = scan.level - at.value;
      sums.add(at, equations.sums.add(residual * per_sigma), residual);
    }
    const SlipSums::Matrix normal = sums.normal(model);
    const SlipSums::Vector gradient = sums.gradient(model);
    block.own = normal.topLeftCorner<3, 3>();
    block.mixed = normal.topRightCorner<3, 3>();
    block.gradient = gradient.head<3>();
    block.capture_s = model.capture_s();
    equations.shared += normal.bottomRightCorner<3, 3>();
    equations.gradient += gradient.tail<3>();
  }

  const model::BeltMotion& belt_;
  const std::vector<SlipWindow>& windows_;
  std::vector<TraceScan> scans_;   ///< Of all windows,
  std::vector<std::size_t> ends_;  ///< and where those of each window end.
  double sigma_;
  const SharedPrior& prior_;
  mutable std::vector<Matrix3d> inverses_;  ///< Memory of step().
};

/// Covariances at the optimum, in terms of the residuals found.
void finish(SlipFit& fit, std::vector<SlipWindow>& windows, const NormalEquations& equations, double sigma) {
  const double parameters = 3.0 + 3.0 * static_cast<double>(windows.size());
  for (const SlipWindow& window : windows) fit.scan_count += window.end - window.first;
  fit.residual_sigma = sigma * equations.sums.residual_sigma(parameters);
  fit.cost = equations.cost;
  fit.cost_scale = equations.sums.cost_scale(parameters);
  fit.freedom = equations.sums.count() - parameters;
  const double variance = sigma * sigma * equations.sums.covariance_scale(parameters);
  Matrix3d reduced = equations.shared;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const SlipBlock& block = equations.slips[i];
    const Matrix3d inverse = block.own.inverse();
    windows[i].inverse_curvature = variance * inverse;
    windows[i].coupling = inverse * block.mixed;
    reduced -= block.mixed.transpose() * windows[i].coupling;
  }
  // The estimate answers to the noise of both, scans and prior, through the one inverse.
  const Matrix3d prior = sigma * sigma * equations.prior.information;
  const Matrix3d response = (reduced + prior).inverse();
  fit.shared_covariance =
      variance * response * reduced * response + sigma * sigma * response * prior * response;
  fit.converged = fit.converged && equations.sums.freedom(parameters) > 0.0 &&
                  fit.shared_covariance.allFinite() && fit.shared_covariance.diagonal().minCoeff() >= 0.0;
}

}  // namespace

SlipFit fit_slips(const Trace& trace, std::vector<SlipWindow>& windows, const model::SharedParameters& shared,
                  double sigma, const SharedPrior& prior, double settled) {
  SlipFit fit;
  fit.shared = shared;
  if (windows.empty()) return fit;
  const SlipsProblem problem{trace, windows, sigma, prior};
  FitState state{shared, {}};
  state.slips.reserve(windows.size());
  for (const SlipWindow& window : windows) state.slips.push_back(window.slip);
  NormalEquations equations;
  problem.assemble(state, equations);
  if (!std::isfinite(equations.cost)) return fit;
  const int most = prior.empty() ? kMostFitIterations : kMostFitIterationsWithPrior;
  fit.converged = minimise(problem, state, equations,
                           {.iterations = most, .absolute = settled, .relative = kFitConverged});
  fit.shared = state.shared;
  for (std::size_t i = 0; i < windows.size(); ++i) windows[i].slip = state.slips[i];
  finish(fit, windows, equations, sigma);
  return fit;
}

Eigen::Matrix3d SlipFit::mean_covariance(const std::vector<SlipWindow>& windows) const {
  Matrix3d own = Matrix3d::Zero();
  Matrix3d coupling = Matrix3d::Zero();
  for (const SlipWindow& window : windows) {
    own += window.inverse_curvature;
    coupling += window.coupling;
  }
  const auto count = static_cast<double>(windows.size());
  coupling /= count;
  return own / (count * count) + coupling * shared_covariance * coupling.transpose();
}

Eigen::Matrix3d SlipFit::covariance(const SlipWindow& window) const {
  return window.inverse_curvature + window.coupling * shared_covariance * window.coupling.transpose();
}

double SlipFit::onset_error_s(const SlipWindow& window) const { return std::sqrt(covariance(window)(0, 0)); }

double SlipFit::delta_mu_error(const SlipWindow& window) const {
  const Eigen::Matrix3d own = covariance(window);
  return std::sqrt(own(1, 1) + own(2, 2) - 2.0 * own(1, 2));
}

}  // namespace stickslip::estimate
