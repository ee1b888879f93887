#include "core/detect/captured_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/estimate/minimise.hpp"

namespace stickslip::detect {
namespace {

void add(CapturedTrajectory::Equations& sum, double residual, const Eigen::Vector4d& by) noexcept {
  sum.cost += 0.5 * residual * residual;
  sum.normal += by * by.transpose();
  sum.gradient -= residual * by;
}

}  // namespace

CapturedTrajectory::CapturedTrajectory(const Parameters& parameters, const model::SharedParameters& shared,
                                       const BeltBelow& belt,
                                       std::optional<double> expected_capture_s) noexcept
    : p_(parameters),
      shared_(shared),
      belt_(belt),
      omega0_squared_(shared.omega * shared.omega + 0.25 * shared.gamma * shared.gamma) {
  const model::SlipWaveform first{p_[0], p_[1], p_[2], shared.oscillator()};
  auto captured_s = expected_capture_s && belt.course->is_constant()
                        ? model::capture_time_near_s(first, shared.r, *expected_capture_s)
                        : std::nullopt;
  if (!captured_s) captured_s = model::capture_time_s(first, *belt.course, shared.r, belt.start_s);
  is_captured_ = captured_s.has_value();
  capture_tau_s_ = captured_s.value_or(first.rise_end_time_s());
  const model::DampedBasis basis = model::damped_basis(first.oscillator, std::max(capture_tau_s_, 0.0));
  by_free_ = {1.0, basis.cosine + 0.5 * shared.gamma * basis.sine, basis.sine};
  rate_by_free_ = {0.0, -omega0_squared_ * basis.sine, basis.cosine - 0.5 * shared.gamma * basis.sine};
  at_capture_ = by_free_.dot(p_.head<3>());
  rate_at_capture_ = belt.course->stick_rate(shared.r, belt.start_s + capture_tau_s_);
  set_next_S(p_[3]);
}

void CapturedTrajectory::set_next_S(double S) noexcept {
  p_[3] = S;
  const model::BeltMotion& belt = *belt_.course;
  onset_tau_s_ = capture_tau_s_ + belt.climbing_time_s(shared_.r, belt_.start_s + capture_tau_s_,
                                                       std::max(S, at_capture_) - at_capture_);
  rate_at_onset_ = belt.stick_rate(shared_.r, belt_.start_s + onset_tau_s_);
  slope_at_onset_ = shared_.r * belt.slope(belt_.start_s + onset_tau_s_);
}

CapturedTrajectory CapturedTrajectory::with_next_delta_mu(double delta_mu) const noexcept {
  CapturedTrajectory other = *this;
  other.set_next_S(p_[0] + delta_mu);
  return other;
}

CapturedTrajectory::Point CapturedTrajectory::after_onset(const ScanRow& row,
                                                          model::TurnedBasis& basis) const noexcept {
  const double gamma = shared_.gamma;
  const double r = rate_at_onset_;
  const double D = std::max(p_[3], at_capture_) - p_[0];
  const auto [cosine, sine] = basis.at(row.tau_s - onset_tau_s_);
  const double swing = D * cosine + (r + 0.5 * gamma * D) * sine;
  const double rate = r * cosine - (0.5 * gamma * r + omega0_squared_ * D) * sine;
  return {p_[0] + swing - row.half_spread_s2 * (gamma * rate + omega0_squared_ * swing), rate,
          cosine + 0.5 * gamma * sine, sine};
}

CapturedTrajectory::Parameters CapturedTrajectory::derivatives(const Point& at) const noexcept {
  // A larger S delays the onset by 1/r; a higher capture advances it by 1/r. The slip begins with the belt's
  // rate at that time.
  const double by_capture = (at.rate - slope_at_onset_ * at.sine) / rate_at_onset_;
  return {by_capture * by_free_[0] + 1.0 - at.by_D, by_capture * by_free_[1], by_capture * by_free_[2],
          at.by_D - by_capture};
}

double CapturedTrajectory::residual(const ScanRow& row, model::TurnedBasis& basis) const noexcept {
  if (row.tau_s <= capture_tau_s_) return row.free_residual(p_.head<3>());
  const double value = row.tau_s <= onset_tau_s_ ? while_stuck(row.tau_s) : after_onset(row, basis).value;
  return (row.value - value) * row.scale;
}

CapturedTrajectory::Equations CapturedTrajectory::unusual(double typical_delta_mu) const noexcept {
  Equations sum;
  const double D = std::max(p_[3], at_capture_) - p_[0];
  const double ratio = D / typical_delta_mu;
  Eigen::Vector4d by = Eigen::Vector4d::Zero();
  if (ratio > kLeastRatio) by = Eigen::Vector4d{-1.0, 0.0, 0.0, 1.0} / (D * kDeltaMuLogScatter);
  add(sum, std::log(std::max(ratio, kLeastRatio)) / kDeltaMuLogScatter, by);
  // At a capture c′ is the stick rate but for rounding, which is not a shortfall.
  if (is_captured_) return sum;
  // At the end of its rise c′ is stationary, so that the shift of that moment drops out.
  const double spread = kStickRateSpread * rate_at_capture_;
  const double shortfall = (rate_at_capture_ - rate_by_free_.dot(p_.head<3>())) / spread;
  if (shortfall > 0.0) {
    by.setZero();
    by.head<3>() = -rate_by_free_ / spread;
    add(sum, shortfall, by);
  }
  return sum;
}

CapturedTrajectory::Equations CapturedTrajectory::equations(std::span<const ScanRow> rows,
                                                            double typical_delta_mu) const noexcept {
  Equations sum = unusual(typical_delta_mu);
  auto row = rows.begin();
  FreeEquations slipping;
  const FreeOscillation free = p_.head<3>();
  for (; row != rows.end() && row->tau_s <= capture_tau_s_; ++row) slipping.add(*row, free);
  sum.cost += slipping.cost;
  sum.normal.topLeftCorner<3, 3>() += slipping.normal();
  sum.gradient.head<3>() += slipping.gradient();
  // c and c′ are continuous at the capture, whose shift drops out: all of a stick moves as its begin does.
  double weights = 0.0;
  double stuck_gradient = 0.0;
  for (; row != rows.end() && row->tau_s <= onset_tau_s_; ++row) {
    const double z = (row->value - while_stuck(row->tau_s)) * row->scale;
    sum.cost += estimate::huber_cost(z, kChoiceLimit);
    const double weight = estimate::huber_weight(z, kChoiceLimit) * row->scale;
    weights += weight * row->scale;
    stuck_gradient += weight * z;
  }
  sum.normal.topLeftCorner<3, 3>() += (weights * by_free_) * by_free_.transpose();
  sum.gradient.head<3>() += stuck_gradient * by_free_;
  model::TurnedBasis basis = turned_basis();
  for (; row != rows.end(); ++row) {
    const Point point = after_onset(*row, basis);
    const double z = (row->value - point.value) * row->scale;
    sum.cost += estimate::huber_cost(z, kChoiceLimit);
    const double weight = estimate::huber_weight(z, kChoiceLimit) * row->scale;
    const Parameters by = derivatives(point);
    sum.normal += (weight * row->scale * by) * by.transpose();
    sum.gradient += weight * z * by;
  }
  return sum;
}

namespace {

/// For minimise(). The trajectory's equations carry it, as its times are their first guess.
struct CaptureProblem {
  using State = CapturedTrajectory::Parameters;
  struct Equations : CapturedTrajectory::Equations {
    CapturedTrajectory trajectory;
  };

  std::span<const ScanRow> rows;
  const model::SharedParameters& shared;
  const BeltBelow& belt;
  double typical_delta_mu;
  double sigma;

  void assemble(const State& at, Equations& equations) const noexcept {
    equations.trajectory = CapturedTrajectory{at, shared, belt, equations.trajectory.capture_s()};
    static_cast<CapturedTrajectory::Equations&>(equations) =
        equations.trajectory.equations(rows, typical_delta_mu);
    if (!(at[3] - at[0] > -sigma)) equations.cost = std::numeric_limits<double>::infinity();
  }

  [[nodiscard]] double step(const State& from, const Equations& equations, double damping,
                            State& to) const noexcept {
    // In units of each parameter's own; the diagonal is one then, also for S where no row lies behind its
    // onset.
    const Eigen::Vector4d unit = equations.normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::Matrix4d scaled = unit.asDiagonal() * equations.normal * unit.asDiagonal();
    scaled.diagonal().setConstant(1.0 + damping);
    const Eigen::Vector4d step = unit.cwiseProduct(scaled.inverse() * unit.cwiseProduct(equations.gradient));
    to = from + step;
    return 0.5 * step.dot(equations.gradient);
  }
};

}  // namespace

FittedCapture fit_captured(const FittedCapture& first, std::span<const ScanRow> rows,
                           const model::SharedParameters& shared, const BeltBelow& belt,
                           double typical_delta_mu, double sigma, int most) noexcept {
  const CaptureProblem problem{rows, shared, belt, typical_delta_mu, sigma};
  CaptureProblem::State state = first.trajectory.parameters();
  CaptureProblem::Equations equations{first.equations, first.trajectory};
  static_cast<void>(
      estimate::minimise(problem, state, equations, {.iterations = most, .absolute = kCostConverged}));
  return {equations.trajectory, equations};
}

}  // namespace stickslip::detect
