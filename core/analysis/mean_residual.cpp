#include "core/analysis/mean_residual.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace stickslip::analysis {

void MeanResidual::add(double periods, double sigmas) noexcept {
  // A missed spike may not pass for what repeats. Noise keeps 99 % of its variance.
  constexpr double kLargest = 3.0;
  const double bin = std::floor((periods - kFrom) / (kTo - kFrom) * static_cast<double>(kBins));
  if (!(bin >= 0.0 && bin < static_cast<double>(kBins))) return;
  Bin& at = bins_[static_cast<std::size_t>(bin)];
  at.sum += std::clamp(sigmas, -kLargest, kLargest);
  at.count += 1.0;
  if (at.latest == slip_) return;
  at.latest = slip_;
  at.slips += 1.0;
}

void MeanResidual::add(const MeanResidual& others) noexcept {
  for (std::size_t i = 0; i < kBins; ++i) {
    bins_[i].sum += others.bins_[i].sum;
    bins_[i].count += others.bins_[i].count;
    bins_[i].slips += others.bins_[i].slips;
  }
}

double MeanResidual::chi_squared() const noexcept {
  double sum = 0.0;
  for_each([&](const Bin& bin, double) { sum += bin.chi_squared(); });
  return sum;
}

double MeanResidual::freedom() const noexcept {
  double bins = 0.0;
  for_each([&](const Bin&, double) { bins += 1.0; });
  return bins;
}

double MeanResidual::count() const noexcept {
  double scans = 0.0;
  for_each([&](const Bin& bin, double) { scans += bin.count; });
  return scans;
}

double MeanResidual::square() const noexcept {
  const double scans = count();
  return scans > 0.0 ? (chi_squared() - freedom()) / scans : 0.0;
}

double MeanResidual::error_of_square(double scans) const noexcept {
  // Of a χ² that is not central, by as much as it lies above its degrees.
  const double all = chi_squared();
  const double beyond = std::max(all - freedom(), 0.0);
  const double variance =
      2.0 * freedom() + 4.0 * beyond + all * all * kVarianceOfNoise / std::max(scans, 1.0);
  return std::sqrt(variance) / std::max(count(), 1.0);
}

double MeanResidual::z(double scans) const noexcept {
  const double degrees = freedom();
  if (!(degrees > 0.0)) return 0.0;
  const double of_root = 2.0 / (9.0 * degrees);
  return (std::cbrt(chi_squared() / degrees) - 1.0 + of_root) /
         std::sqrt(of_root + kVarianceOfNoise / std::max(scans, 1.0) / 9.0);
}

double MeanResidual::birge_ratio() const noexcept {
  const double degrees = freedom();
  return degrees > 0.0 ? std::max(std::sqrt(chi_squared() / degrees), 1.0) : 1.0;
}

std::optional<double> MeanResidual::swing() const noexcept {
  constexpr double kLowest = 2.0;  // The fit follows slower ones.
  constexpr double kHighest = 20.0;
  constexpr double kStep = 0.125;  // Over one period: an eighth of a swing at most.
  constexpr double kShare = 0.5;
  double all = 0.0;
  double scans = 0.0;
  for_each([&](const Bin& bin, double periods) {
    if (periods < 0.0) return;
    all += bin.chi_squared() - 1.0;
    scans += bin.count;
  });
  double largest = 0.0;
  double at = 0.0;
  for (double frequency = kLowest; frequency <= kHighest; frequency += kStep) {
    std::complex<double> sum;
    for_each([&](const Bin& bin, double periods) {
      if (periods >= 0.0) sum += std::polar(bin.sum, 2.0 * std::numbers::pi * frequency * periods);
    });
    const double explained = 2.0 * std::norm(sum) / std::max(scans, 1.0);
    if (explained > largest) {
      largest = explained;
      at = frequency;
    }
  }
  return largest > kShare * all && all > 0.0 ? std::optional{at} : std::nullopt;
}

}  // namespace stickslip::analysis
