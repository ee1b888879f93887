#include "core/detect/capture_test.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace stickslip::detect {
namespace {

/// Fewest rows for an evaluation: twice the four parameters of the captured trajectory.
constexpr std::size_t kFewestRows = 8;
/// Error allowed in the bounds of a cost, log-likelihood units: iterative reweighting may end this far above
/// the minimum.
constexpr double kBoundsSlack = 1.0;
/// Largest improvement by a new fit, log-likelihood units, for which the last captured trajectory is used
/// again; its times of capture and onset are then unchanged.
constexpr double kStillBest = 1.0;

/// Likelihood of a residual z, as noise or as an outlier.
double mixture(double z) noexcept { return std::exp(-0.5 * z * z) + kStrayDensity; }

/// ln of a product of many factors, for the price of few logarithms.
class LogOfProduct {
 public:
  void multiply(double factor) noexcept {
    product_ *= factor;
    if (product_ > kLarge || product_ < 1.0 / kLarge) {
      sum_ += std::log(product_);
      product_ = 1.0;
    }
  }
  [[nodiscard]] double value() const noexcept { return sum_ + std::log(product_); }

 private:
  static constexpr double kLarge = 1e150;  // A factor more is still a number.
  double product_ = 1.0;
  double sum_ = 0.0;
};

}  // namespace

void CaptureTest::lay_out(std::span<const estimate::CyclePoint> points, const CapturePrior& prior) noexcept {
  std::size_t kept = rows_.lay_out(points, prior.shared, prior.sigma);
  const BeltBelow belt{prior.belt, points.front().time_s};
  if (prior.typical_delta_mu != prior_.typical_delta_mu || prior.next_delta_mu != prior_.next_delta_mu ||
      prior.shared.r != prior_.shared.r || belt != belt_) {
    kept = 0;
  }
  prior_ = prior;
  belt_ = belt;
  if (kept < last_count_) last_count_ = 0;
  if (kept < common_count_) common_count_ = 0;
  if (strays_) rows_.readmit(common_count_, rows_.size());
  strays_ = false;
}

bool CaptureTest::leave_out_a_stray_of_both(const Trajectories& trajectories) noexcept {
  // One stray alone costs as much: below that there is none.
  const double least = estimate::huber_cost(estimate::kStraySigmas, kChoiceLimit);
  if (trajectories.free_cost < least || trajectories.captured.equations.cost < least) return false;
  model::TurnedBasis basis = trajectories.captured.trajectory.turned_basis();
  return rows_.leave_out_a_stray(common_count_, rows_.size(), [&](const ScanRow& row) {
    return std::min(std::abs(row.free_residual(trajectories.free)),
                    std::abs(trajectories.captured.trajectory.residual(row, basis)));
  });
}

void CaptureTest::fit_common() noexcept {
  // Up to the trough, half an oscillation after the peak, the two are the same trajectory.
  const double half_s = std::numbers::pi / prior_.shared.omega;
  const auto rows = rows_.all();
  const auto same = static_cast<std::size_t>(
      std::ranges::find_if(rows, [&](const ScanRow& row) { return !(row.tau_s < half_s); }) - rows.begin());
  const std::size_t count = std::max<std::size_t>(same, 4);
  if (count == common_count_) return;
  common_count_ = count;
  last_count_ = 0;
  rows_.readmit(0, count);
  common_ = FreeOscillation::Zero();
  do {
    common_cost_ = fit_free(rows.first(count), common_);
  } while (rows_.leave_out_a_stray(0, count, [&](const ScanRow& row) { return row.free_residual(common_); }));
  CapturedTrajectory::Parameters p;
  p << common_, common_[0] + prior_.next_delta_mu.value_or(prior_.typical_delta_mu);
  usual_ = CapturedTrajectory{p, prior_.shared, belt_};
}

double CaptureTest::carried_on_cost() const noexcept {
  double cost = common_cost_;
  for (const ScanRow& row : rows_.all().subspan(common_count_))
    cost += estimate::huber_cost(row.free_residual(common_), kChoiceLimit);
  return cost;
}

bool CaptureTest::is_misfit(double cost) const noexcept {
  return 2.0 * cost > kMisfitSigmas * kMisfitSigmas * static_cast<double>(rows_.size());
}

CaptureTest::Bounds CaptureTest::last_captured_bounds() const noexcept {
  if (last_count_ == 0) return {common_cost_, std::numeric_limits<double>::infinity()};
  Bounds bounds{last_captured_.equations.cost, last_captured_.equations.cost};
  model::TurnedBasis basis = last_captured_.trajectory.turned_basis();
  for (const ScanRow& row : rows_.all().subspan(last_count_))
    bounds.most += estimate::huber_cost(last_captured_.trajectory.residual(row, basis), kChoiceLimit);
  return bounds;
}

double CaptureTest::log_likelihood_ratio(const Trajectories& trajectories,
                                         double residual_sigmas) const noexcept {
  const double per_sigma = 1.0 / std::max(residual_sigmas, 1.0);
  LogOfProduct rows;
  model::TurnedBasis basis = trajectories.captured.trajectory.turned_basis();
  for (const ScanRow& row : rows_.all()) {
    rows.multiply(mixture(trajectories.captured.trajectory.residual(row, basis) * per_sigma) /
                  mixture(row.free_residual(trajectories.free) * per_sigma));
  }
  const double unusual = trajectories.captured.trajectory.unusual(prior_.typical_delta_mu).cost;
  return rows.value() - unusual * per_sigma * per_sigma;
}

void CaptureTest::fit_captured_trajectory(Trajectories& trajectories, const FittedCapture& usual,
                                          const Budget& budget) const noexcept {
  const auto fit = [&](const FittedCapture& from) {
    return fit_captured(from, rows_.all(), prior_.shared, belt_, prior_.typical_delta_mu, rows_.sigma(),
                        budget.iterations);
  };
  trajectories.captured = fit(usual);
  // No second fit is needed if the next slip has not begun and the free trajectory is no better, or if the
  // result is decisive already.
  const double cost = trajectories.captured.equations.cost;
  if (cost <= trajectories.free_cost && trajectories.captured.trajectory.onset_tau_s() > rows_.back().tau_s)
    return;
  const bool is_decisive =
      budget.decisive > 0.0 && cost <= trajectories.free_cost - budget.decisive - kBoundsSlack;
  if (is_decisive && !is_misfit(cost)) return;
  // The cost has two minima: at the typical S − K of the next slip, and near zero.
  constexpr double kHardlyAny = 0.1;
  const CapturedTrajectory slight = usual_.with_next_delta_mu(kHardlyAny * prior_.typical_delta_mu);
  const FittedCapture other = fit({slight, slight.equations(rows_.all(), prior_.typical_delta_mu)});
  if (other.equations.cost < trajectories.captured.equations.cost) trajectories.captured = other;
}

CaptureEvidence CaptureTest::evidence_of(const Trajectories& trajectories, double first_s) const noexcept {
  CaptureEvidence evidence;
  evidence.known = true;
  evidence.capture_s = first_s + trajectories.captured.trajectory.capture_tau_s();
  evidence.next_onset_s = first_s + trajectories.captured.trajectory.onset_tau_s();
  // Where both leave more than noise, the scans tell less than they seem to.
  evidence.residual_sigmas =
      std::sqrt(2.0 * std::min(trajectories.free_cost, trajectories.captured.equations.cost) /
                static_cast<double>(rows_.size()));
  evidence.log_likelihood_ratio = log_likelihood_ratio(trajectories, evidence.residual_sigmas);
  return evidence;
}

CaptureEvidence CaptureTest::evaluate(std::span<const estimate::CyclePoint> points, const CapturePrior& prior,
                                      const Budget& budget) noexcept {
  CaptureEvidence evidence;
  if (points.empty() || points.size() > estimate::CycleBuffer::kMostPoints) return evidence;
  lay_out(points, prior);
  if (rows_.size() < kFewestRows) return evidence;
  evidence.known = true;
  fit_common();

  // Most evaluations come too early to decide. A trajectory costs at least what the best of its kind costs
  // for the common part or for the rows of the last answer, and at most what any of its kind costs for all
  // rows: where these bounds leave no room for a decisive answer, it is not worked out.
  Bounds free{common_cost_, carried_on_cost()};
  const Bounds last = last_captured_bounds();
  Bounds captured = last;
  const double room = budget.decisive - kBoundsSlack;
  const auto cannot_be_captured = [&] { return free.most - captured.least < room; };
  const auto cannot_tell = [&] {
    return cannot_be_captured() && captured.most - free.least < room &&
           !is_misfit(std::min(free.most, captured.most));
  };
  // Before the usual capture the usual captured trajectory is the free one. (But for what a shortfall of c′
  // would add: the answer may come later.)
  if (rows_.back().tau_s <= usual_.capture_tau_s()) captured.most = std::min(captured.most, free.most);
  if (cannot_tell()) return evidence;
  const auto usual_now = [&] {
    return FittedCapture{usual_, usual_.equations(rows_.all(), prior_.typical_delta_mu)};
  };
  std::optional<FittedCapture> usual;
  if (cannot_be_captured()) {
    usual = usual_now();
    captured.most = std::min(captured.most, usual->equations.cost);
    if (cannot_tell()) return evidence;
  }
  Trajectories trajectories;
  trajectories.free = common_;
  trajectories.free_cost = fit_free(rows_.all(), trajectories.free);
  free = {trajectories.free_cost, trajectories.free_cost};
  if (!usual && cannot_be_captured()) {
    usual = usual_now();
    captured.most = std::min(captured.most, usual->equations.cost);
  }
  if (cannot_tell()) return evidence;
  if (budget.decisive > 0.0 && last.most - last.least < kStillBest) {
    // A fit would make the last captured trajectory better by that much at most.
    trajectories.captured = last_captured_;
    trajectories.captured.equations.cost = last.most;
    evidence = evidence_of(trajectories, points.front().time_s);
    const double ratio = evidence.log_likelihood_ratio;
    const bool tells = ratio > budget.decisive || std::abs(ratio) + (last.most - last.least) < room;
    if (tells && evidence.residual_sigmas <= kMisfitSigmas) return evidence;
  }
  if (!usual) usual = usual_now();
  if (budget.enough < std::numeric_limits<double>::infinity()) {
    trajectories.captured = *usual;
    evidence = evidence_of(trajectories, points.front().time_s);
    if (evidence.log_likelihood_ratio > budget.enough) return evidence;
  }
  fit_captured_trajectory(trajectories, *usual, budget);
  while (leave_out_a_stray_of_both(trajectories)) {
    strays_ = true;
    trajectories.free_cost = fit_free(rows_.all(), trajectories.free);
    fit_captured_trajectory(trajectories, usual_now(), budget);
  }
  last_captured_ = trajectories.captured;
  last_count_ = strays_ ? 0 : rows_.size();
  return evidence_of(trajectories, points.front().time_s);
}

}  // namespace stickslip::detect
