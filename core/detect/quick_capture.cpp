#include "core/detect/quick_capture.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/detect/junction.hpp"

namespace stickslip::detect {
namespace {

/// Fewest rows before the capture: more than the three parameters of the slip.
constexpr double kFewestBeforeCapture = 5.0;
/// Limit of the rounds that alternate between the capture time and the fit of the rows before it.
constexpr int kMostCaptureRounds = 4;
/// Limit of the steps towards the least cost; the first is nearly sufficient.
constexpr int kMostCaptureSteps = 3;
/// Decrease of the cost, log-likelihood units, below which the iteration ends.
constexpr double kSmallGain = 0.1;
/// S − K that is typical but for such a part costs nothing.
constexpr double kTypical = 1e-3;

}  // namespace

Crossing find_stick(const SlipRows& slip, const RowCourse& p, StickBegin& begin) noexcept {
  const double r = slip.shared().r;
  const double by_cosine = slip.motion(p, {1.0, 0.0}).rate;
  const double by_sine = slip.motion(p, {0.0, 1.0}).rate;
  const auto rate = [&](const TurnedBasis& b) { return by_cosine * b.cosine + by_sine * b.sine; };
  const auto next_to = [&](std::size_t row) {
    return row + 1 < slip.size() ? slip.basis(row + 1) : slip.a_row_later(slip.basis(row));
  };
  // c′ rises from the middle of the fall on.
  std::size_t row = slip.half();
  if (row == 0 || row + 1 >= slip.size()) return Crossing::kToCome;
  if (begin.row > row && begin.row < slip.size() && rate(slip.basis(begin.row - 1)) < r) row = begin.row - 1;
  double before = rate(slip.basis(row));
  if (before >= r) return Crossing::kNever;  // Of another course than a slip's.
  double after = rate(next_to(row));
  while (after < r) {
    if (!(after > before)) return Crossing::kNever;
    before = after;
    if (++row + 1 < slip.size()) {
      after = rate(slip.basis(row + 1));
      continue;
    }
    for (TurnedBasis b = slip.basis(row);; before = after) {
      b = slip.a_row_later(b);
      after = rate(b);
      if (after >= r) return Crossing::kToCome;
      if (!(after > before)) return Crossing::kNever;
    }
  }
  if (!(after >= r)) return Crossing::kNever;  // No number.
  if (row + 1 >= slip.size()) return Crossing::kToCome;
  // From that row on by Taylor's series. Between two rows c′ is nearly straight, so that one step is left; c
  // does not feel an error of the moment.
  const auto [swing, first, second, third] = slip.motion(p, slip.basis(row));
  const double fourth = -slip.shared().gamma * third - slip.omega0_squared() * second;
  const double start = slip.row_s() * (r - before) / (after - before);
  const double off = first - r + start * (second + start * (third / 2.0 + start * fourth / 6.0));
  const double slope = second + start * (third + start * fourth / 2.0);
  const double t = std::clamp(start - off / slope, 0.0, slip.row_s());
  begin.row = row;
  begin.tau_s = slip.tau_s(row) + t;
  begin.level = p.K + swing + t * (first + t * (second / 2.0 + t * (third / 6.0 + t * fourth / 24.0)));
  begin.basis = slip.later(slip.basis(row), t);
  return Crossing::kThere;
}

RiseEnd find_rise_end(const SlipRows& slip, const RowCourse& p) noexcept {
  RiseEnd end;
  end.row = std::min(slip.half(), slip.size() - 1);
  end.basis = slip.basis(end.row);
  for (; end.row < slip.half(); ++end.row) end.basis = slip.a_row_later(end.basis);
  SlipRows::Motion motion = slip.motion(p, end.basis);
  while (true) {
    const TurnedBasis next =
        end.row + 1 < slip.size() ? slip.basis(end.row + 1) : slip.a_row_later(end.basis);
    const SlipRows::Motion after = slip.motion(p, next);
    if (!(after.rate > motion.rate)) break;
    motion = after;
    end.basis = next;
    ++end.row;
  }
  // Less than a row from there c′ is a parabola.
  end.rate = motion.rate;
  if (motion.jerk < 0.0) end.rate -= 0.5 * motion.acceleration * motion.acceleration / motion.jerk;
  return end;
}

Crossing QuickCapture::start(const SlipRows& slip, std::size_t guess, double typical_delta_mu,
                             double row_variance) noexcept {
  typical_delta_mu_ = typical_delta_mu;
  row_variance_ = row_variance;
  stick_.row = guess;
  // The capture is known by the course of the rows before it.
  for (int round = 0; round < kMostCaptureRounds; ++round) {
    const std::size_t row = stick_.row;
    if (slip.sums(row).n < kFewestBeforeCapture) return Crossing::kNever;
    p_ = slip.fit(row).course;
    S_ = p_.K + typical_delta_mu;
    const Crossing crossing = work_out(slip);
    if (crossing != Crossing::kThere || stick_.row == row) return crossing;
  }
  return Crossing::kThere;
}

void QuickCapture::improve(const SlipRows& slip, double enough) noexcept {
  for (int step = 0; step < kMostCaptureSteps && cost_ > enough; ++step) {
    const auto [normal, gradient] = equations(slip);
    // All four are coefficients, of one scale: cofactors are exact enough.
    const Eigen::Vector4d x = normal.inverse() * gradient;
    if (!(0.5 * x.dot(gradient) > kSmallGain * row_variance_)) return;
    QuickCapture next = *this;
    next.p_ = {p_.K + x[0], p_.A + x[1], p_.B + x[2]};
    next.S_ = S_ + x[3];
    if (next.work_out(slip) != Crossing::kThere || !(next.cost_ < cost_)) return;
    *this = next;
  }
}

Crossing QuickCapture::work_out(const SlipRows& slip) noexcept {
  const auto& [omega, gamma, r] = slip.shared();
  if (const Crossing crossing = find_stick(slip, p_, stick_); crossing != Crossing::kThere) return crossing;
  const auto& [K, A, B] = p_;
  S_ = std::max(S_, stick_.level);
  onset_tau_s_ = stick_.tau_s + (S_ - stick_.level) / r;
  next_D_ = S_ - K;
  next_B_ = (r + 0.5 * gamma * next_D_) / omega;

  // Rows before the capture: a parabola about the least they can cost.
  const SlipRows::Sums& sums = slip.sums(stick_.row);
  double square_sum = sums.yy + K * (sums.n * K - 2.0 * sums.y) + A * (sums.cc * A - 2.0 * sums.yc) +
                      B * (sums.ss * B - 2.0 * sums.ys) +
                      2.0 * (sums.c * K * A + sums.s * K * B + sums.cs * A * B);
  square_sum = std::max(square_sum, 0.0);  // Whatever the digits lose.
  const auto leave = [&](std::size_t k, double value, const TurnedBasis& = {}) {
    const double off = slip.value(k) - value;
    square_sum += slip.weight(k) * off * off;
  };
  for_each_behind(slip, leave, leave);

  // Its S − K is log-normal about what is typical.
  const double ratio = next_D_ / typical_delta_mu_;
  unusual_ =
      std::abs(ratio - 1.0) > kTypical ? std::log(std::max(ratio, kLeastRatio)) / kDeltaMuLogScatter : 0.0;
  cost_ = 0.5 * (square_sum / row_variance_ + unusual_ * unusual_);
  return Crossing::kThere;
}

QuickCapture::Equations QuickCapture::equations(const SlipRows& slip) const noexcept {
  const model::SharedParameters& shared = slip.shared();
  const auto& [K, A, B] = p_;
  const SlipRows::Sums& sums = slip.sums(stick_.row);

  double n00 = sums.n;
  double n10 = sums.c;
  double n20 = sums.s;
  double n30 = 0.0;
  double n11 = sums.cc;
  double n21 = sums.cs;
  double n31 = 0.0;
  double n22 = sums.ss;
  double n32 = 0.0;
  double n33 = 0.0;
  double g0 = sums.y - (sums.n * K + sums.c * A + sums.s * B);
  double g1 = sums.yc - (sums.c * K + sums.cc * A + sums.cs * B);
  double g2 = sums.ys - (sums.s * K + sums.cs * A + sums.ss * B);
  double g3 = 0.0;
  const double by_A = stick_.basis.cosine;
  const double by_B = stick_.basis.sine;
  const auto on_line = [&](std::size_t k, double value) {
    // All of the line moves as its begin does: c and c′ are continuous there, so its shift drops out.
    const double w = slip.weight(k);
    const double off = w * (slip.value(k) - value);
    n00 += w;
    n10 += w * by_A;
    n20 += w * by_B;
    n11 += w * by_A * by_A;
    n21 += w * by_A * by_B;
    n22 += w * by_B * by_B;
    g0 += off;
    g1 += off * by_A;
    g2 += off * by_B;
  };
  const RowCourse next{0.0, next_D_, next_B_};
  const auto in_next = [&](std::size_t k, double value, const TurnedBasis& b) {
    // Its onset comes later by 1/r for each S, and earlier by what the capture is higher.
    const double w = slip.weight(k);
    const double off = w * (slip.value(k) - value);
    const double by_capture = slip.motion(next, b).rate / shared.r;
    const double by_D = b.cosine + 0.5 * shared.gamma / shared.omega * b.sine;
    const double d0 = by_capture + 1.0 - by_D;
    const double d1 = by_capture * by_A;
    const double d2 = by_capture * by_B;
    const double d3 = by_D - by_capture;
    n00 += w * d0 * d0;
    n10 += w * d1 * d0;
    n20 += w * d2 * d0;
    n30 += w * d3 * d0;
    n11 += w * d1 * d1;
    n21 += w * d2 * d1;
    n31 += w * d3 * d1;
    n22 += w * d2 * d2;
    n32 += w * d3 * d2;
    n33 += w * d3 * d3;
    g0 += off * d0;
    g1 += off * d1;
    g2 += off * d2;
    g3 += off * d3;
  };
  for_each_behind(slip, on_line, in_next);

  // S − K that is unusual.
  const double by_S = next_D_ > kLeastRatio * typical_delta_mu_ ? 1.0 / (next_D_ * kDeltaMuLogScatter) : 0.0;
  const double information = row_variance_ * by_S * by_S;
  const double pull = row_variance_ * unusual_ * by_S;
  n00 += information;
  n30 -= information;
  n33 += information;
  g0 += pull;
  g3 -= pull;
  Equations by;
  by.normal << n00, n10, n20, n30, n10, n11, n21, n31, n20, n21, n22, n32, n30, n31, n32, n33;
  by.gradient << g0, g1, g2, g3;
  return by;
}

}  // namespace stickslip::detect
