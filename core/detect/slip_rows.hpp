/// \file
/// The rows of one slip at equal intervals, and the free oscillation fitted to them: least squares from
/// running sums, without transcendental functions for each row.
///
///     slip.begin(rows, now_s, peak_s, level, shared);
///     slip.take(rows);                                   // Those that have come since.
///     const auto free = slip.fit(slip.size() - 1);       // Through all of them.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include <Eigen/Core>

#include "core/detect/scan_rows.hpp"
#include "core/model/slip_model.hpp"

namespace stickslip::detect {

/// e^{−γt/2} cos ωt and e^{−γt/2} sin ωt.
struct TurnedBasis {
  double cosine = 1.0;
  double sine = 0.0;
};

/// Parameters of a free oscillation: K, and the factors of cosine and sine.
struct RowCourse {
  double K = 0.0;
  double A = 0.0;
  double B = 0.0;
};

/// A free oscillation is linear in its three parameters, and a rotation gives the basis of the next row. The
/// sums of products up to each row are stored and give the smallest cost over these rows. A level is
/// subtracted from the values, for precision. Fixed size; never allocates.
class SlipRows {
 public:
  static constexpr std::size_t kMost = ScanRows::kMost;

  /// Sums of the normal equations (1, cosine, sine, value) up to a row. Members have no initial values, since
  /// an array of them is only partly used.
  struct Sums {
    double n;
    double y;
    double c;
    double s;
    double cc;
    double cs;
    double yc;
    double ys;
    double ss;
    double yy;
  };
  struct Fit {
    RowCourse course;
    double square_sum = 0.0;  ///< Residual sum of squares.
  };

  /// \param now_s  time of the last scan.
  /// \param peak_s  rows from this time on belong to the slip.
  /// \return whether all of them are stored.
  [[nodiscard]] bool begin(const ScanRows& rows, double now_s, double peak_s, double level,
                           const model::SharedParameters& shared) noexcept;
  /// \param until_s  only those before. \return whether there was room for them.
  [[nodiscard]] bool take(const ScanRows& rows,
                          double until_s = std::numeric_limits<double>::infinity()) noexcept;

  [[nodiscard]] const model::SharedParameters& shared() const noexcept { return shared_; }
  [[nodiscard]] double omega0_squared() const noexcept { return omega0_squared_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] double row_s() const noexcept { return row_s_; }
  /// Last row of the first half period, in which a capture is impossible.
  [[nodiscard]] std::size_t half() const noexcept { return half_; }
  [[nodiscard]] double first_s() const noexcept { return first_s_; }
  [[nodiscard]] double tau_s(std::size_t k) const noexcept { return static_cast<double>(k) * row_s_; }
  [[nodiscard]] double value(std::size_t k) const noexcept { return values_[k]; }
  [[nodiscard]] double weight(std::size_t k) const noexcept { return weights_[k]; }
  [[nodiscard]] TurnedBasis basis(std::size_t k) const noexcept { return {cosines_[k], sines_[k]}; }
  [[nodiscard]] const Sums& sums(std::size_t k) const noexcept { return sums_[k]; }

  [[nodiscard]] TurnedBasis a_row_later(const TurnedBasis& b) const noexcept {
    return {turn_.cosine * b.cosine - turn_.sine * b.sine, turn_.sine * b.cosine + turn_.cosine * b.sine};
  }
  /// \param time_s  of a row at most: a series, 3·10⁻⁵ off at eight rows a period.
  [[nodiscard]] TurnedBasis later(const TurnedBasis& b, double time_s) const noexcept;

  /// c − K and its derivatives where a course has this basis.
  struct Motion {
    double swing;
    double rate;
    double acceleration;
    double jerk;
  };
  [[nodiscard]] Motion motion(const RowCourse& p, const TurnedBasis& b) const noexcept;
  /// Residuals of the rows [0, size) about a free oscillation. An Eigen expression: do not store it.
  [[nodiscard]] auto off(const RowCourse& p, std::size_t size) const noexcept {
    return column(values_, size) - p.K - (attenuation_ * p.A) * column(cosines_, size) -
           (attenuation_ * p.B) * column(sines_, size);
  }
  /// Mean of c − K over a row, relative to its value in the middle of the row.
  [[nodiscard]] double attenuation() const noexcept { return attenuation_; }
  [[nodiscard]] auto weights() const noexcept { return column(weights_, size_); }

  /// Least-squares free oscillation through the rows 0 … k; k ≥ 2.
  [[nodiscard]] Fit fit(std::size_t k) const noexcept;
  /// Variance of d · (K, A, B) of fit(k), for values of variance 1.
  [[nodiscard]] double variance(std::size_t k, const RowCourse& d) const noexcept;

 private:
  using Column = std::array<double, kMost>;

  [[nodiscard]] static Eigen::Map<const Eigen::ArrayXd> column(const Column& values,
                                                               std::size_t size) noexcept {
    return {values.data(), static_cast<Eigen::Index>(size)};
  }

  model::SharedParameters shared_;
  double omega0_squared_ = 0.0;
  double row_s_ = 0.0;
  std::size_t half_ = 0;
  TurnedBasis turn_;          ///< Of a row.
  double attenuation_ = 1.0;  ///< Of an oscillation by the mean over a row.
  double level_ = 0.0;
  std::size_t first_row_ = 0;
  double first_s_ = 0.0;
  std::size_t size_ = 0;
  std::size_t known_ = 0;  ///< Of the basis, for these ω and γ.
  // Of the rows before size_ or known_.
  Column values_;
  Column weights_;
  Column cosines_;
  Column sines_;
  std::array<Sums, kMost> sums_;
};

inline SlipRows::Motion SlipRows::motion(const RowCourse& p, const TurnedBasis& b) const noexcept {
  const auto& [omega, gamma, r] = shared_;
  const double half_gamma = 0.5 * gamma;
  Motion m{};
  m.swing = p.A * b.cosine + p.B * b.sine;
  m.rate = (omega * p.B - half_gamma * p.A) * b.cosine - (omega * p.A + half_gamma * p.B) * b.sine;
  // c − K and all its derivatives obey the same equation of motion, f″ = −γ f′ − ω₀² f.
  m.acceleration = -gamma * m.rate - omega0_squared_ * m.swing;
  m.jerk = -gamma * m.acceleration - omega0_squared_ * m.rate;
  return m;
}

}  // namespace stickslip::detect
