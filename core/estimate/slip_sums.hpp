/// \file
/// Normal equations of many scans about one slip, from sums over what their derivatives are made of: a third
/// of the operations that six derivatives of each scan take.
///
///     SlipSums sums;
///     for (…) sums.add(model.place(time_s, basis), weight, value - place.value);
///     const Eigen::Matrix<double, 6, 6> normal = sums.normal(model);
#pragma once

#include <array>

#include <Eigen/Core>

#include "core/model/slip_model.hpp"

namespace stickslip::estimate {

/// Sums over scans about one slip, for the parameters (onset, S, K, ω, γ, r).
class SlipSums {
 public:
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = model::SlipModelPoint::Derivatives;

  /// Adds a scan.
  /// \param at  its model::SlipModel::place().
  /// \param residual  scan less model, in any unit. The model is at.value; for the mean of several scans a
  ///        caller adds the effect of the curvature.
  void add(const model::SlipPlace& at, double weight, double residual) noexcept {
    const double off = weight * residual;
    if (at.phase != model::SlipPhase::kSlip) {
      Stick& stick = at.phase == model::SlipPhase::kBefore ? before_ : after_;
      stick.ones += weight;
      stick.ways += weight * at.way_s;
      stick.squares += weight * at.way_s * at.way_s;
      stick.off += off;
      stick.off_ways += off * at.way_s;
      return;
    }
    const Terms terms = model::SlipModel::slip_terms(at);
    for (int j = 0, k = 0; j < kTerms; ++j) {
      const double weighted = weight * terms[j];
      for (int i = 0; i <= j; ++i) products_[static_cast<std::size_t>(k++)] += weighted * terms[i];
    }
    off_ += off * terms;
  }

  /// Σ weight · by byᵀ, with the derivatives `by` of the model. \param model  the one that made the places.
  [[nodiscard]] Matrix normal(const model::SlipModel& model) const noexcept {
    Eigen::Matrix<double, kTerms, kTerms> products;
    for (int j = 0, k = 0; j < kTerms; ++j) {
      for (int i = 0; i <= j; ++i) products(i, j) = products(j, i) = products_[static_cast<std::size_t>(k++)];
    }
    const model::SlipModel::SlipCoefficients& by = model.slip_coefficients();
    const model::SlipModel::SlipCoefficients half = by * products;
    Matrix normal;
    normal.noalias() = half * by.transpose();
    add_stick(before_, model.stick_begin(model::SlipPhase::kBefore), normal);
    add_stick(after_, model.stick_begin(model::SlipPhase::kAfter), normal);
    return normal;
  }
  /// Σ weight · residual · by.
  [[nodiscard]] Vector gradient(const model::SlipModel& model) const noexcept {
    Vector gradient = model.slip_coefficients() * off_;
    gradient += before_.off * model.stick_begin(model::SlipPhase::kBefore);
    gradient += after_.off * model.stick_begin(model::SlipPhase::kAfter);
    gradient[kRate] += before_.off_ways + after_.off_ways;
    return gradient;
  }

 private:
  static constexpr int kTerms = 5;
  static constexpr int kRate = 5;  ///< Index of r.
  using Terms = Eigen::Matrix<double, kTerms, 1>;

  /// Sums over a stick.
  struct Stick {
    double ones = 0.0;
    double ways = 0.0;
    double squares = 0.0;
    double off = 0.0;
    double off_ways = 0.0;
  };
  static void add_stick(const Stick& stick, const Vector& begin, Matrix& normal) noexcept {
    normal.noalias() += (stick.ones * begin) * begin.transpose();
    normal.row(kRate) += stick.ways * begin.transpose();
    normal.col(kRate) += stick.ways * begin;
    normal(kRate, kRate) += stick.squares;
  }

  Stick before_;
  Stick after_;
  std::array<double, kTerms*(kTerms + 1) / 2> products_{};  ///< Of two terms, of the slip.
  Terms off_ = Terms::Zero();
};

}  // namespace stickslip::estimate
