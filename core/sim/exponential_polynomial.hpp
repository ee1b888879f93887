/// \file
/// Function of time: the sum of a polynomial and a few exponential decays. It describes belt speed, drift of
/// K, and the force without its oscillation.
///
///     ExponentialPolynomial speed{0.01};                     // v = 0.01 − 0.002 t + 0.003 (1 − e^(−5t))
///     speed.add_power(1, -0.002);
///     speed.add_decay(5.0, 1, 0.003 * 5.0);
///     const double way = speed.integral().value(2.0);
#pragma once

#include <array>

#include "core/model/oscillator.hpp"

namespace stickslip::sim {

/// Σ a_k t^k + Σ_j Σ_m b_jm φ_m(λ_j, t) for t ≥ 0, with φ₀ = e^(−λt) and φ_m = ∫₀ᵗ φ_(m−1).
///
/// φ₁ = (1 − e^(−λt))/λ, φ₂ = (t − φ₁)/λ …: integrals of a slow decay stay accurate where e^(−λt) and the
/// polynomial that it nearly is would cancel; λ may be of any sign.
class ExponentialPolynomial {
 public:
  static constexpr int kPowers = 6;  ///< k = 0 … 5
  static constexpr int kOrders = 5;  ///< m = 0 … 4
  static constexpr int kDecays = 3;

  /// The terms of one λ: Σ_m weight[m] φ_m(λ, t).
  struct Decay {
    double rate_per_s = 0.0;  ///< λ ≠ 0
    int orders = 0;           ///< Weights of this m and above are zero.
    std::array<double, kOrders> weight{};
  };

  ExponentialPolynomial() = default;
  explicit ExponentialPolynomial(double constant) { add_power(0, constant); }

  /// Adds a t^k.
  void add_power(int k, double a);
  /// Adds b φ_m(λ, t), m = `order`; for λ = 0 this is b t^m/m!. Aborts, like every operation here, if the
  /// result would have a power of kPowers or more, an order of kOrders or more, or more than kDecays
  /// different λ.
  void add_decay(double rate_per_s, int order, double b);
  ExponentialPolynomial& operator+=(const ExponentialPolynomial& other);

  [[nodiscard]] double value(double t_s) const noexcept;
  /// Sum of the absolute values of the terms; the rounding error of value() is relative to it.
  [[nodiscard]] double magnitude(double t_s) const noexcept;
  [[nodiscard]] ExponentialPolynomial scaled(double factor) const;
  [[nodiscard]] ExponentialPolynomial derivative() const;
  /// Integral from 0 to t. Raises powers and orders by one.
  [[nodiscard]] ExponentialPolynomial integral() const;
  /// The function at t + by_s, as a function of t. \param by_s ≥ 0
  [[nodiscard]] ExponentialPolynomial later(double by_s) const;
  /// Derivative plus λ times the function, for the λ of decay(index); the result has no decay with this λ.
  [[nodiscard]] ExponentialPolynomial without_decay(int index) const;
  /// Forced response: the solution p of p″ + γp′ + ω₀² p = ω₀² (this) that is again a polynomial with the
  /// same decays. Requires that no decay is near resonance: each |distance_from_resonance()| well above zero.
  [[nodiscard]] ExponentialPolynomial response(const model::Oscillator& oscillator) const;

  [[nodiscard]] int powers() const noexcept { return powers_; }  ///< Highest k + 1; 0: no polynomial.
  /// Number of different λ; one whose weights have cancelled counts too.
  [[nodiscard]] int decays() const noexcept { return decays_; }
  /// a_k. \param k  0 … kPowers − 1; a_k = 0 from k = powers() on.
  [[nodiscard]] double power(int k) const { return power_.at(static_cast<std::size_t>(k)); }
  /// \param index  0 … decays() − 1.
  [[nodiscard]] const Decay& decay(int index) const { return decay_.at(static_cast<std::size_t>(index)); }
  [[nodiscard]] bool is_constant() const noexcept { return powers_ <= 1 && decays_ == 0; }

 private:
  int powers_ = 0;
  int decays_ = 0;
  std::array<double, kPowers> power_{};
  std::array<Decay, kDecays> decay_{};
};

/// φ₀ … φ_(count−1) of λ = rate_per_s at t ≥ 0; the others are 0. \param count  0 … kOrders
[[nodiscard]] std::array<double, ExponentialPolynomial::kOrders> decay_integrals(double rate_per_s,
                                                                                 double t_s, int count);

/// (λ² − γλ + ω₀²)/ω₀²: distance of the decay e^(−λt) from a free motion of the oscillator. It is
/// zero at resonance and negative between two resonances; if the oscillator oscillates, always above zero.
[[nodiscard]] double distance_from_resonance(double rate_per_s, const model::Oscillator& oscillator);

}  // namespace stickslip::sim
