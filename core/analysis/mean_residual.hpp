/// \file
/// Mean residual of the slips at each time since their onset. Noise averages out of it; what the model leaves
/// out repeats in each slip and stays: a transducer that rings or is slow, another friction law.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace stickslip::analysis {

/// Variance of σ² over σ⁴ times the scans that told σ: signal::scan_noise() has a relative standard error of
/// 2/√n, by simulation of white noise, n from 600 on.
inline constexpr double kVarianceOfNoise = 16.0;

class MeanResidual {
 public:
  /// The residuals that follow are those of another slip.
  void begin_slip() noexcept { slip_ += 1.0; }
  /// \param periods  time since the onset over the period of the oscillation, negative in the stick before.
  /// \param sigmas  residual of one scan over the noise of a scan.
  void add(double periods, double sigmas) noexcept;
  /// Adds those of other slips.
  void add(const MeanResidual& others) noexcept;

  /// χ² of the means of all bins that have enough slips, of freedom() degrees for noise alone; less where the
  /// fit has taken a part of it.
  [[nodiscard]] double chi_squared() const noexcept;
  [[nodiscard]] double freedom() const noexcept;  ///< Bins that have enough slips.
  [[nodiscard]] double count() const noexcept;    ///< Scans in these bins.

  /// Square of what repeats in each slip, in σ²: negative by chance.
  [[nodiscard]] double square() const noexcept;

  /// Standard error of square() where so many scans told σ.
  [[nodiscard]] double error_of_square(double scans) const noexcept;

  /// How far χ² lies above that of noise, in standard errors of a normal distribution, σ being told by so
  /// many scans. [Wilson and Hilferty, PNAS 17:684–688, 1931]
  [[nodiscard]] double z(double scans) const noexcept;

  /// Factor by which the errors of a fit are larger than the noise makes them, √(χ²/freedom); at least 1.
  /// [Birge, Phys. Rev. 40:207–227, 1932]
  [[nodiscard]] double birge_ratio() const noexcept;

  /// Frequency, over that of the oscillation, of the one sine that explains half of what repeats after the
  /// onset; nullopt if none does.
  [[nodiscard]] std::optional<double> swing() const noexcept;

 private:
  // From half a period before the onset to one after it; a swing of 20 times the frequency has two bins.
  static constexpr double kFrom = -0.5;
  static constexpr double kTo = 1.0;
  static constexpr std::size_t kBins = 64;
  static constexpr double kFewest = 4.0;  ///< Slips of a mean: what few have alike may be chance, as hum is.

  struct Bin {
    double sum = 0.0;
    double count = 0.0;  ///< Scans.
    double slips = 0.0;
    double latest = 0.0;  ///< Slip of the latest scan.
    [[nodiscard]] double chi_squared() const noexcept { return sum * sum / count; }
  };
  [[nodiscard]] static double periods_of(std::size_t bin) noexcept {
    return kFrom + (static_cast<double>(bin) + 0.5) * (kTo - kFrom) / static_cast<double>(kBins);
  }
  /// Calls each(bin, its periods) of those that have enough slips.
  template <typename Each>
  void for_each(const Each& each) const {
    for (std::size_t i = 0; i < kBins; ++i) {
      if (bins_[i].slips >= kFewest) each(bins_[i], periods_of(i));
    }
  }

  double slip_ = 0.0;  ///< The one at hand, from 1 on.
  std::array<Bin, kBins> bins_;
};

}  // namespace stickslip::analysis
