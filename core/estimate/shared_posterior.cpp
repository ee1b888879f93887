#include "core/estimate/shared_posterior.hpp"

#include <cmath>

#include <Eigen/LU>

#include "core/model/tester.hpp"

namespace stickslip::estimate {
namespace {

/// Standard deviation of the initial γ/2ω of a tester without characterisation; it covers 0 to three times
/// the typical value. A dozen cycles determine it ten times better (docs/detector.md).
constexpr double kGammaOver2OmegaSpread = 0.05;
/// Relative standard deviations of the initial ω, from turning points, and of the initial stick rate, from
/// the slope of a rise; they cover the worst case, three scans from peak to trough.
constexpr double kOmegaSpread = 0.15;
constexpr double kFirstStickRateSpread = 0.3;
/// Factor by which learnt information fades with each cycle: an effective memory of 32 cycles.
constexpr double kKept = 31.0 / 32.0;
/// Fraction of the initial information that does not fade. It keeps the information matrix regular where the
/// cycles determine nothing, as turning points determine nothing of γ; with fading alone the matrix would
/// underflow after 20 000 cycles. Where the cycles do determine a parameter it is negligible.
constexpr double kNeverFades = 1e-6;
/// Limit of the rounds in which the prior is linearised again about the new estimate.
constexpr int kKnowledgeRounds = 3;
/// Step in standard deviations below which the rounds end; the next step would be about its square.
constexpr double kSettledSigmas = 1e-3;

double inverse_square(double x) noexcept { return 1.0 / (x * x); }

Eigen::Vector3d vector_of(const model::SharedParameters& shared) noexcept {
  return {shared.omega, shared.gamma, shared.r};
}

}  // namespace

void SharedPosterior::start(double omega, double stick_rate_per_s) {
  best_ = {omega, 2.0 * model::kTypicalGammaOver2Omega * omega, stick_rate_per_s};
  learnt_ = {};
  if (prior_.coupling) {
    best_.omega = prior_.coupling->omega;
    best_.gamma = 2.0 * prior_.coupling->gamma_over_2omega * prior_.coupling->omega;
  } else {
    learnt_.information(0, 0) = inverse_square(kOmegaSpread * omega);
    learnt_.information(1, 1) = inverse_square(2.0 * kGammaOver2OmegaSpread * omega);
  }
  if (prior_.belt) {
    best_.r = prior_.belt->speed_over_gravity_s * best_.oscillator().omega0_squared();
  } else {
    learnt_.information(2, 2) = inverse_square(kFirstStickRateSpread * stick_rate_per_s);
  }
  learnt_.weighted = learnt_.information * vector_of(best_);
  lasting_ = {kNeverFades * learnt_.information, kNeverFades * learnt_.weighted};
}

void SharedPosterior::learn(const SharedEvidence& evidence) {
  if (!evidence.information.allFinite() || !evidence.weighted.allFinite()) return;
  learnt_.information =
      lasting_.information + kKept * (learnt_.information - lasting_.information) + evidence.information;
  learnt_.weighted = lasting_.weighted + kKept * (learnt_.weighted - lasting_.weighted) + evidence.weighted;
  update_best();
}

void SharedPosterior::forget_stick_rate(double stick_rate_per_s) {
  // Of the Gaussian that was learnt, the distribution of (ω, γ) whatever r is; then r anew.
  const double own = learnt_.information(2, 2);
  if (own > 0.0) {
    const Eigen::Vector3d column = learnt_.information.col(2);
    const double weighted = learnt_.weighted[2];
    learnt_.information -= column * column.transpose() / own;
    learnt_.weighted -= column * (weighted / own);
  }
  learnt_.information.row(2).setZero();
  learnt_.information.col(2).setZero();
  learnt_.information(2, 2) = inverse_square(kFirstStickRateSpread * stick_rate_per_s);
  learnt_.weighted[2] = learnt_.information(2, 2) * stick_rate_per_s;
  lasting_.information(2, 2) = kNeverFades * learnt_.information(2, 2);
  lasting_.weighted[2] = kNeverFades * learnt_.weighted[2];
  best_.r = stick_rate_per_s;
}

PriorTerms SharedPosterior::at(const model::SharedParameters& shared) const {
  PriorTerms terms = prior_.at(shared);
  const Eigen::Vector3d x = vector_of(shared);
  const Eigen::Vector3d pull = learnt_.weighted - learnt_.information * x;
  terms.information += learnt_.information;
  terms.gradient += pull;
  // ½ (x − m)ᵀ I (x − m) up to a constant, which no step changes, counted from the best value: no difference
  // of large numbers.
  const Eigen::Vector3d off = x - vector_of(best_);
  terms.cost += 0.5 * off.dot(learnt_.information * off) -
                off.dot(learnt_.weighted - learnt_.information * vector_of(best_));
  return terms;
}

void SharedPosterior::update_best() {
  for (int round = 0; round < kKnowledgeRounds; ++round) {
    const PriorTerms terms = at(best_);
    // Scales of ω, γ and r differ by orders: each by its own.
    const Eigen::Vector3d scale = terms.information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d scaled = scale.asDiagonal() * terms.information * scale.asDiagonal();
    const Eigen::Vector3d scaled_step = scaled.inverse() * scale.cwiseProduct(terms.gradient);
    const Eigen::Vector3d step = scale.cwiseProduct(scaled_step);
    const model::SharedParameters next{best_.omega + step[0], best_.gamma + step[1], best_.r + step[2]};
    if (!step.allFinite() || !(next.omega > 0.0) || !(next.r > 0.0) ||
        !(std::abs(next.gamma) < 2.0 * next.omega)) {
      return;
    }
    best_ = next;
    // What is learnt is linear, and after a small step what is known beforehand is as well.
    const bool settled = scaled_step.squaredNorm() < kSettledSigmas * kSettledSigmas;
    if (settled || !(prior_.coupling || prior_.belt)) return;
  }
}

}  // namespace stickslip::estimate
