// The first rise of an oscillation on a course: Rolle's chain.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "core/base/contract.hpp"
#include "core/sim/bracket.hpp"
#include "core/sim/first_rise.hpp"

namespace stickslip::sim {
namespace {

using model::SlipWaveform;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kNever = std::numeric_limits<double>::infinity();

/// h′ + λh, which is a motion of the same oscillator.
SlipWaveform damped_derivative(const SlipWaveform& h, double rate) {
  const double slope = -h.oscillator.gamma_per_s * h.r - h.oscillator.omega0_squared() * h.D;
  return {0.0, h.r + rate * h.D, slope + rate * h.r, h.oscillator};
}

/// First zero after t of a wave that is not zero everywhere; never if none.
double next_zero(const SlipWaveform& h, double t) {
  const double sine = h.r + h.oscillator.gamma_per_s * h.D / 2.0;  // h = decay (D · C + sine · Sn)
  if (h.oscillator.oscillates()) {
    const double omega = h.oscillator.omega_rad_per_s();
    const double half_period = std::numbers::pi / omega;
    const double first = (std::atan2(sine, omega * h.D) + std::numbers::pi / 2.0) / omega;
    double index = std::floor((t - first) / half_period) + 1.0;
    if (first + index * half_period <= t) index += 1.0;
    return first + index * half_period;
  }
  // tanh(κt)/κ = −D/sine
  const double kappa = std::sqrt(-h.oscillator.omega_squared);
  const double quotient = -h.D / sine;
  if (!(quotient * kappa < 1.0)) return kNever;
  const double zero = kappa > 0.0 ? std::atanh(kappa * quotient) / kappa : quotient;
  return zero > t ? zero : kNever;
}

/// Where a function that changes its sign once between low and high does so.
double change_between(const Curve& y, double low, double high, double sign_at_high) {
  const auto excess = [&](double t) { return sign_at_high * y.value(t); };
  // A bracket of the size of its lower end: the far end of a motion may be ages away.
  double near = std::min(high, low + std::max(1.0, low));
  while (near < high && excess(near) < 0.0) near = std::min(high, low + 4.0 * (near - low));
  return rise_between(excess, low, near);
}

double sign_of(double x) { return x > 0.0 ? 1.0 : (x < 0.0 ? -1.0 : 0.0); }

/// The levels of the chain and how far each has been followed.
class Chain {
 public:
  Chain(const Curve& y, double from, double to) : to_(to) {
    add(y, from);
    while (true) {
      const Curve& last = levels_.at(count_ - 1).y;
      Curve next{last.wave, {}};
      if (last.course.decays() > 0) {
        next.course = last.course.without_decay(0);
        next.wave = damped_derivative(last.wave, last.course.decay(0).rate_per_s);
      } else if (last.course.powers() > 0 || count_ == 1) {
        next.course = last.course.derivative();
        next.wave = damped_derivative(last.wave, 0.0);
      } else {
        break;
      }
      add(next, from);
    }
  }

  /// The next moment at which this level changes its sign; never if that is not before the end.
  double next(std::size_t index) {
    Level& level = levels_.at(index);
    if (index + 1 == count_) {
      if (!level.y.oscillates()) return kNever;
      level.at = next_zero(level.y.wave, level.at);
      return level.at;
    }
    while (level.at < to_) {
      const double low = level.at;
      const double high = std::min(next(index + 1), to_);
      const double sign = sign_of(level.y.value(high));
      const bool changes = sign * level.sign < 0.0;
      level.at = high;
      if (sign != 0.0) level.sign = sign;  // It only touches zero where it turns.
      if (changes) return change_between(level.y, low, high, sign);
    }
    return kNever;
  }

 private:
  struct Level {
    Curve y;
    double at = 0.0;
    double sign = 0.0;
  };
  static constexpr std::size_t kMaxLevels =
      2 + ExponentialPolynomial::kPowers + ExponentialPolynomial::kDecays;

  void add(const Curve& y, double from) {
    STICKSLIP_EXPECTS(count_ < kMaxLevels);
    levels_.at(count_++) = {y, from, sign_of(y.value(from))};
  }

  double to_;
  std::size_t count_ = 0;
  std::array<Level, kMaxLevels> levels_;
};

std::optional<double> rise_within(const Curve& y, double from, double to, double noise, bool& below,
                                  Touch touch) {
  Chain chain{y, from, to};
  double low = from;
  while (true) {
    const double high = std::min(chain.next(1), to);
    const double at_high = y.value(high);
    const bool rises = below ? at_high > 0.0 : at_high > noise && y.value(low) <= noise;
    const bool touches = below && at_high == 0.0 && touch == Touch::kCounts;
    if (rises || touches) {
      return y.value(low) >= 0.0 ? low : change_between(y, low, high, 1.0);
    }
    if (at_high < -noise) below = true;
    if (!(high < to)) return std::nullopt;
    low = high;
  }
}

/// The most that y can be: its course and the amplitude to which the oscillation has decayed.
Curve envelope(const Curve& y) {
  const model::Oscillator& oscillator = y.wave.oscillator;
  const double sine = (y.wave.r + oscillator.gamma_per_s * y.wave.D / 2.0) / oscillator.omega_rad_per_s();
  Curve most{{0.0, 0.0, 0.0, oscillator}, y.course};
  most.course.add_decay(oscillator.gamma_per_s / 2.0, 0, std::hypot(y.wave.D, sine));
  return most;
}

}  // namespace

std::optional<double> first_rise_s(const Curve& y, double from_s, double end_s, Touch touch) {
  const auto noise_at = [](const Curve& curve, double t) {
    const double swing = curve.oscillates() ? std::abs(curve.wave.value(t)) : 0.0;
    return 16.0 * kEpsilon * (curve.course.magnitude(t) + swing);
  };
  const double noise = noise_at(y, from_s);
  bool below = y.value(from_s) < -noise;
  if (!y.oscillates() || !y.wave.oscillator.oscillates())
    return rise_within(y, from_s, end_s, noise, below, touch);

  const Curve most = envelope(y);
  const double window_s = 4.0 * std::numbers::pi / y.wave.oscillator.omega_rad_per_s();
  for (double from = from_s; from < end_s;) {
    const double to = std::min(from + window_s, end_s);
    if (const auto rise = rise_within(y, from, to, noise, below, touch)) return rise;
    from = to;
    const double rounding = noise_at(most, to);
    if (from < end_s && most.value(to) < rounding) {
      bool under = most.value(to) < -rounding;
      const auto back = rise_within(most, to, end_s, rounding, under, Touch::kDoesNot);
      if (!back) return std::nullopt;
      from = *back;
      below = true;
    }
  }
  return std::nullopt;
}

}  // namespace stickslip::sim
