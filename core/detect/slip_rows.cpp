#include "core/detect/slip_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stickslip::detect {

bool SlipRows::begin(const ScanRows& rows, double now_s, double peak_s, double level,
                     const model::SharedParameters& shared) noexcept {
  const double newest_s = rows.newest_s(now_s);
  const auto scans = static_cast<double>(rows.scans_per_row());
  const double count = std::floor((newest_s - peak_s) / rows.row_s()) + 1.0;
  if (!(count >= 1.0) || count > static_cast<double>(std::min(rows.count(), kMost))) return false;
  if (shared.omega != shared_.omega || shared.gamma != shared_.gamma || rows.row_s() != row_s_) {
    row_s_ = rows.row_s();
    omega0_squared_ = shared.omega * shared.omega + 0.25 * shared.gamma * shared.gamma;
    const double decay = std::exp(-0.5 * shared.gamma * row_s_);
    turn_ = {decay * std::cos(shared.omega * row_s_), decay * std::sin(shared.omega * row_s_)};
    // sin(nx)/(n sin x) of half a scan's phase x, to the third order.
    const double phase = shared.omega * rows.scan_s();
    attenuation_ = 1.0 - (scans * scans - 1.0) * phase * phase / 24.0;
    cosines_[0] = 1.0;
    sines_[0] = 0.0;
    known_ = 1;
  }
  shared_ = shared;
  level_ = level;
  first_row_ = rows.count() - static_cast<std::size_t>(count);
  first_s_ = newest_s - (count - 1.0) * row_s_;
  half_ =
      static_cast<std::size_t>(std::max(std::numbers::pi / shared.omega - (first_s_ - peak_s), 0.0) / row_s_);
  size_ = 0;
  return true;
}

bool SlipRows::take(const ScanRows& rows, double until_s) noexcept {
  std::size_t end = rows.count() - first_row_;
  if (end > kMost) return false;
  if (const double before = std::ceil((until_s - first_s_) / row_s_); before < static_cast<double>(end))
    end = static_cast<std::size_t>(std::max(before, 0.0));
  for (; known_ < end; ++known_) {
    const TurnedBasis next = a_row_later(basis(known_ - 1));
    cosines_[known_] = next.cosine;
    sines_[known_] = next.sine;
  }
  // Two sums at a time.
  using Pair = Eigen::Array2d;
  const Sums before = size_ == 0 ? Sums{} : sums_[size_ - 1];
  Pair n_y{before.n, before.y};
  Pair c_s{before.c, before.s};
  Pair cc_cs{before.cc, before.cs};
  Pair yc_ys{before.yc, before.ys};
  Pair ss_yy{before.ss, before.yy};
  for (; size_ < end; ++size_) {
    const auto [value, w] = rows[first_row_ + size_];
    const double y = value - level_;
    const Pair basis = attenuation_ * Pair{cosines_[size_], sines_[size_]};
    const Pair weighted = w * basis;
    const double wy = w * y;
    n_y += Pair{w, wy};
    c_s += weighted;
    cc_cs += weighted * basis[0];
    yc_ys += weighted * y;
    ss_yy += Pair{weighted[1], wy} * Pair{basis[1], y};
    values_[size_] = y;
    weights_[size_] = w;
    sums_[size_] = {n_y[0],   n_y[1],   c_s[0],   c_s[1],   cc_cs[0],
                    cc_cs[1], yc_ys[0], yc_ys[1], ss_yy[0], ss_yy[1]};
  }
  return true;
}

TurnedBasis SlipRows::later(const TurnedBasis& b, double time_s) const noexcept {
  const double decay = 0.5 * shared_.gamma * time_s;
  const double phase = shared_.omega * time_s;
  const double square = phase * phase;
  const double part = 1.0 - decay * (1.0 - 0.5 * decay);
  const double cosine = part * (1.0 - square * (1.0 / 2.0 - square * (1.0 / 24.0 - square / 720.0)));
  const double sine = part * phase * (1.0 - square * (1.0 / 6.0 - square / 120.0));
  return {cosine * b.cosine - sine * b.sine, sine * b.cosine + cosine * b.sine};
}

namespace {

/// The normal matrix eliminated: LDLᵀ with unit lower L.
struct Eliminated {
  explicit Eliminated(const SlipRows::Sums& sums) noexcept : per_n(1.0 / sums.n) {
    l1 = sums.c * per_n;
    l2 = sums.s * per_n;
    const double cc = sums.cc - l1 * sums.c;
    const double cs = sums.cs - l1 * sums.s;
    per_cc = 1.0 / cc;
    m = cs * per_cc;
    per_ss = 1.0 / (sums.ss - l2 * sums.s - m * cs);
  }
  double per_n;
  double l1;
  double l2;
  double per_cc;
  double m;
  double per_ss;
};

}  // namespace

SlipRows::Fit SlipRows::fit(std::size_t k) const noexcept {
  const Sums& sums = sums_[k];
  const Eliminated by{sums};
  const double yc = sums.yc - by.l1 * sums.y;
  const double ys = sums.ys - by.l2 * sums.y - by.m * yc;
  Fit fit;
  RowCourse& p = fit.course;
  p.B = ys * by.per_ss;
  p.A = yc * by.per_cc - by.m * p.B;
  p.K = sums.y * by.per_n - by.l1 * p.A - by.l2 * p.B;
  // Never less than nothing, whatever the digits lose.
  fit.square_sum = std::max(sums.yy - by.per_n * sums.y * sums.y - by.per_cc * yc * yc - ys * p.B, 0.0);
  return fit;
}

double SlipRows::variance(std::size_t k, const RowCourse& d) const noexcept {
  const Eliminated by{sums_[k]};
  const double u1 = d.A - by.l1 * d.K;
  const double u2 = d.B - by.l2 * d.K - by.m * u1;
  return by.per_n * d.K * d.K + by.per_cc * u1 * u1 + by.per_ss * u2 * u2;
}

}  // namespace stickslip::detect
