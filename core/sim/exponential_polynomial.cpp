#include "core/sim/exponential_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/contract.hpp"

namespace stickslip::sim {
namespace {

constexpr std::array<double, 8> kFactorial{1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0};

double factorial(int n) { return kFactorial.at(static_cast<std::size_t>(n)); }

double power_of(double t, int k) {
  double product = 1.0;
  for (int i = 0; i < k; ++i) product *= t;
  return product;
}

/// t^m Σ (−λt)^k/(k + m)!; for |λt| < 1 twenty terms leave 1/20! = 4e-19.
double integral_series(double rate, double t, int order) {
  constexpr int kSeriesTerms = 20;
  double sum = 1.0;
  for (int k = kSeriesTerms; k >= 1; --k) sum = 1.0 - rate * t / (k + order) * sum;
  return power_of(t, order) / factorial(order) * sum;
}

}  // namespace

std::array<double, ExponentialPolynomial::kOrders> decay_integrals(double rate, double t, int count) {
  std::array<double, ExponentialPolynomial::kOrders> phi{};
  if (count == 0) return phi;
  const double z = rate * t;
  phi[0] = std::exp(-z);
  if (count > 1) phi[1] = rate == 0.0 ? t : -std::expm1(-z) / rate;
  if (std::abs(z) < 1.0) {
    // Downwards nothing cancels: φ_(m−1) = t^(m−1)/(m−1)! − λφ_m.
    const int top = count - 1;
    if (top >= 2) phi.at(static_cast<std::size_t>(top)) = integral_series(rate, t, top);
    for (int m = top; m > 2; --m) {
      phi.at(static_cast<std::size_t>(m - 1)) =
          power_of(t, m - 1) / factorial(m - 1) - rate * phi.at(static_cast<std::size_t>(m));
    }
    return phi;
  }
  for (int m = 2; m < count; ++m) {
    phi.at(static_cast<std::size_t>(m)) =
        (power_of(t, m - 1) / factorial(m - 1) - phi.at(static_cast<std::size_t>(m - 1))) / rate;
  }
  return phi;
}

double distance_from_resonance(double rate, const model::Oscillator& oscillator) {
  return 1.0 + rate * (rate - oscillator.gamma_per_s) / oscillator.omega0_squared();
}

void ExponentialPolynomial::add_power(int k, double a) {
  STICKSLIP_EXPECTS(k >= 0 && k < kPowers);
  if (a == 0.0) return;
  power_.at(static_cast<std::size_t>(k)) += a;
  powers_ = std::max(powers_, k + 1);
  while (powers_ > 0 && power(powers_ - 1) == 0.0) --powers_;
}

void ExponentialPolynomial::add_decay(double rate, int order, double b) {
  STICKSLIP_EXPECTS(order >= 0 && order < kOrders);
  if (b == 0.0) return;
  if (rate == 0.0) {
    add_power(order, b / factorial(order));
    return;
  }
  int index = 0;
  while (index < decays_ && decay(index).rate_per_s != rate) ++index;
  STICKSLIP_EXPECTS(index < kDecays);
  decays_ = std::max(decays_, index + 1);
  Decay& term = decay_.at(static_cast<std::size_t>(index));
  term.rate_per_s = rate;
  term.weight.at(static_cast<std::size_t>(order)) += b;
  term.orders = std::max(term.orders, order + 1);
}

ExponentialPolynomial& ExponentialPolynomial::operator+=(const ExponentialPolynomial& other) {
  for (int k = 0; k < other.powers_; ++k) add_power(k, other.power(k));
  for (int j = 0; j < other.decays_; ++j) {
    const Decay& term = other.decay(j);
    for (int m = 0; m < term.orders; ++m)
      add_decay(term.rate_per_s, m, term.weight.at(static_cast<std::size_t>(m)));
  }
  return *this;
}

double ExponentialPolynomial::value(double t) const noexcept {
  double sum = 0.0;
  for (std::size_t k = static_cast<std::size_t>(powers_); k-- > 0;) sum = sum * t + power_[k];
  for (std::size_t j = 0; j < static_cast<std::size_t>(decays_); ++j) {
    const Decay& term = decay_[j];
    const auto phi = decay_integrals(term.rate_per_s, t, term.orders);
    for (std::size_t m = 0; m < kOrders; ++m) sum += term.weight[m] == 0.0 ? 0.0 : term.weight[m] * phi[m];
  }
  return sum;
}

double ExponentialPolynomial::magnitude(double t) const noexcept {
  double sum = 0.0;
  for (std::size_t k = static_cast<std::size_t>(powers_); k-- > 0;) sum = sum * t + std::abs(power_[k]);
  for (std::size_t j = 0; j < static_cast<std::size_t>(decays_); ++j) {
    const Decay& term = decay_[j];
    const auto phi = decay_integrals(term.rate_per_s, t, term.orders);
    for (std::size_t m = 0; m < kOrders; ++m)
      sum += term.weight[m] == 0.0 ? 0.0 : std::abs(term.weight[m] * phi[m]);
  }
  return sum;
}

ExponentialPolynomial ExponentialPolynomial::scaled(double factor) const {
  ExponentialPolynomial result;
  for (int k = 0; k < powers_; ++k) result.add_power(k, factor * power(k));
  for (int j = 0; j < decays_; ++j) {
    const Decay& term = decay(j);
    for (int m = 0; m < term.orders; ++m)
      result.add_decay(term.rate_per_s, m, factor * term.weight.at(static_cast<std::size_t>(m)));
  }
  return result;
}

ExponentialPolynomial ExponentialPolynomial::derivative() const {
  ExponentialPolynomial result;
  for (int k = 1; k < powers_; ++k) result.add_power(k - 1, k * power(k));
  for (int j = 0; j < decays_; ++j) {
    const Decay& term = decay(j);
    result.add_decay(term.rate_per_s, 0, -term.rate_per_s * term.weight[0]);
    for (int m = 1; m < term.orders; ++m)
      result.add_decay(term.rate_per_s, m - 1, term.weight.at(static_cast<std::size_t>(m)));
  }
  return result;
}

ExponentialPolynomial ExponentialPolynomial::integral() const {
  ExponentialPolynomial result;
  for (int k = 0; k < powers_; ++k) result.add_power(k + 1, power(k) / (k + 1));
  for (int j = 0; j < decays_; ++j) {
    const Decay& term = decay(j);
    for (int m = 0; m < term.orders; ++m)
      result.add_decay(term.rate_per_s, m + 1, term.weight.at(static_cast<std::size_t>(m)));
  }
  return result;
}

ExponentialPolynomial ExponentialPolynomial::later(double by) const {
  ExponentialPolynomial result;
  // Taylor's shift by repeated synthetic division.
  std::array<double, kPowers> shifted = power_;
  for (int k = 0; k < powers_; ++k) {
    for (int i = powers_ - 2; i >= k; --i)
      shifted.at(static_cast<std::size_t>(i)) += by * shifted.at(static_cast<std::size_t>(i) + 1);
  }
  for (int k = 0; k < powers_; ++k) result.add_power(k, shifted.at(static_cast<std::size_t>(k)));
  for (int j = 0; j < decays_; ++j) {
    const Decay& term = decay(j);
    const auto phi = decay_integrals(term.rate_per_s, by, term.orders);
    for (int m = 0; m < term.orders; ++m) {
      const double weight = term.weight.at(static_cast<std::size_t>(m));
      result.add_decay(term.rate_per_s, m, weight * phi[0]);
      for (int k = 0; k < m; ++k)
        result.add_power(k, weight * phi.at(static_cast<std::size_t>(m - k)) / factorial(k));
    }
  }
  return result;
}

ExponentialPolynomial ExponentialPolynomial::without_decay(int index) const {
  const double rate = decay(index).rate_per_s;
  ExponentialPolynomial others = *this;
  others.decay_.at(static_cast<std::size_t>(index)) = others.decay_.at(static_cast<std::size_t>(decays_ - 1));
  others.decay_.at(static_cast<std::size_t>(decays_ - 1)) = {};
  --others.decays_;
  ExponentialPolynomial result = others.derivative();
  result += others.scaled(rate);
  // φ_m′ + λφ_m = t^(m−1)/(m−1)!, nothing for φ₀.
  for (int m = 1; m < decay(index).orders; ++m)
    result.add_power(m - 1, decay(index).weight.at(static_cast<std::size_t>(m)) / factorial(m - 1));
  return result;
}

ExponentialPolynomial ExponentialPolynomial::response(const model::Oscillator& oscillator) const {
  const double gamma = oscillator.gamma_per_s;
  const double omega0_squared = oscillator.omega0_squared();
  ExponentialPolynomial result;
  std::array<double, kPowers + 2> drive{};  // Of the polynomial, without the factor ω₀².
  for (int k = 0; k < powers_; ++k) drive.at(static_cast<std::size_t>(k)) = power(k);
  int highest = powers_ - 1;
  for (int j = 0; j < decays_; ++j) {
    const Decay& term = decay(j);
    const double rate = term.rate_per_s;
    for (int m = 0; m < term.orders; ++m) {
      const double b =
          term.weight.at(static_cast<std::size_t>(m)) / distance_from_resonance(rate, oscillator);
      result.add_decay(rate, m, b);
      // With φ_(m−1) = t^(m−1)/(m−1)! − λφ_m, bφ_m leaves b (γ − λ) t^(m−1)/(m−1)! + b t^(m−2)/(m−2)!.
      if (m >= 1)
        drive.at(static_cast<std::size_t>(m - 1)) -= b * (gamma - rate) / factorial(m - 1) / omega0_squared;
      if (m >= 2) drive.at(static_cast<std::size_t>(m - 2)) -= b / factorial(m - 2) / omega0_squared;
      highest = std::max(highest, m - 1);
    }
  }
  std::array<double, kPowers + 2> p{};
  for (int k = highest; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    p.at(at) =
        drive.at(at) - (gamma * (k + 1) * p.at(at + 1) + (k + 2) * (k + 1) * p.at(at + 2)) / omega0_squared;
    result.add_power(k, p.at(at));
  }
  return result;
}

}  // namespace stickslip::sim
