/// \file
/// Mean residual of the slips at each time since their onset. Noise averages out of it; what the model leaves
/// out repeats in each slip and stays: a transducer that rings or is slow, another friction law.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

namespace stickslip::analysis {

/// n Var(σ²)/σ⁴ if σ was estimated from n scans. signal::scan_noise() has a relative standard error of 2/√n,
/// by simulation of white noise, n from 600 on.
inline constexpr double kVarianceOfNoise = 16.0;

/// Residuals of a fit, averaged over the slips in bins of the time since the onset.
class MeanResidual {
 public:
  /// Residuals added from now on are those of another slip. Call it before the first add().
  void begin_slip() noexcept { slip_ += 1.0; }
  /// \param periods  time since the onset over the period of the oscillation, negative in the stick before;
  ///         ignored outside [−0.5, 1).
  /// \param sigmas  residual of one scan over the noise of a scan; counts as ±3 at most.
  void add(double periods, double sigmas) noexcept;
  /// Adds the residuals of other slips.
  void add(const MeanResidual& others) noexcept;

  /// χ² of the means of all bins with at least four slips. Of noise alone it has freedom() degrees of
  /// freedom, or fewer, since the fit has taken a part of it.
  [[nodiscard]] double chi_squared() const noexcept;
  [[nodiscard]] double freedom() const noexcept;  ///< Bins with at least four slips.
  [[nodiscard]] double count() const noexcept;    ///< Scans in these bins.

  /// Mean square of what repeats in each slip, in σ²: (χ² − freedom())/count(). May be negative by chance; 0
  /// if no bin has four slips.
  [[nodiscard]] double square() const noexcept;

  /// Standard error of square(), in σ².
  /// \param scans  number from which σ was estimated.
  [[nodiscard]] double error_of_square(double scans) const noexcept;

  /// How far χ² lies above that of noise, in standard deviations of a normal distribution; 0 if no bin has
  /// four slips. [Wilson and Hilferty, PNAS 17:684–688, 1931]
  /// \param scans  number from which σ was estimated.
  [[nodiscard]] double z(double scans) const noexcept;

  /// Factor by which what repeats makes the errors of a fit larger than noise does: √(χ²/freedom), ≥ 1.
  /// [Birge, Phys. Rev. 40:207–227, 1932]
  [[nodiscard]] double birge_ratio() const noexcept;

  /// Frequency, over that of the oscillation, of the sine between 2 and 20 that explains most of what repeats
  /// after the onset; nullopt unless it explains more than half, and if nothing repeats.
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
