#include "core/detect/free_oscillation.hpp"

#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace stickslip::detect {
namespace {

/// Limit of the rounds of reweighting; the weights of a linear model converge in two or three.
constexpr int kReweightings = 3;

}  // namespace

double fit_free(std::span<const ScanRow> rows, FreeOscillation& p) noexcept {
  double before = std::numeric_limits<double>::infinity();
  bool unweighted = true;  // So was the last step: the first, as weights need a trajectory.
  for (int round = 0;; ++round) {
    FreeEquations sum;
    for (const ScanRow& row : rows) sum.add(row, p, round > 0);
    if (round > 0) {
      const bool solved = unweighted && sum.all_within;
      if (solved || round == kReweightings || std::abs(before - sum.cost) < kCostConverged) return sum.cost;
      unweighted = sum.all_within;
      before = sum.cost;
    }
    const Eigen::Matrix3d normal = sum.normal();
    // by_rate is smaller than the others by ω: its own unit.
    const Eigen::Vector3d scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    const Eigen::Matrix3d scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    // Of three equal scales: cofactors are exact enough.
    const Eigen::Vector3d step = scale.cwiseProduct(scaled.inverse() * scale.cwiseProduct(sum.gradient()));
    if (step.allFinite()) p += step;
  }
}

}  // namespace stickslip::detect
