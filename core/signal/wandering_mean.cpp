#include "core/signal/wandering_mean.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace stickslip::signal {
namespace {

/// Of fewer values nothing is told about their correlation.
constexpr std::size_t kFewest = 8;
constexpr double kPriorOfWhite = 0.8;

/// Generalised least squares of a constant mean: vᵀV⁻¹v − (1ᵀV⁻¹v)²/1ᵀV⁻¹1, and logarithms of determinants.
struct Likelihood {
  double q = 0.0;
  double log_determinants = 0.0;  ///< ln |V| + ln 1ᵀV⁻¹1
};

/// By the Kalman filter of a wandering level under white noise [Harvey, Forecasting, Structural Time Series
/// Models and the Kalman Filter, 1989, section 3.4]: innovations of the values and of ones. \param kept
/// e^(−1/τ). \param white  w. \param values  about zero.
Likelihood likelihood_of(std::span<const double> values, double kept, double white) noexcept {
  double level = 0.0;
  double level_of_ones = 0.0;
  double variance = 1.0 - white;
  double s_vv = 0.0;
  double s_v1 = 0.0;
  double s_11 = 0.0;
  double determinant = 1.0;
  Likelihood result;
  for (const double value : values) {
    const double innovation_variance = variance + white;
    const double off = value - level;
    const double off_of_one = 1.0 - level_of_ones;
    const double gain = variance / innovation_variance;
    s_vv += off * off / innovation_variance;
    s_v1 += off * off_of_one / innovation_variance;
    s_11 += off_of_one * off_of_one / innovation_variance;
    determinant *= innovation_variance;
    if (determinant < 1e-200) {
      result.log_determinants += std::log(determinant);
      determinant = 1.0;
    }
    level = kept * (level + gain * off);
    level_of_ones = kept * (level_of_ones + gain * off_of_one);
    variance = kept * kept * white * gain + (1.0 - kept * kept) * (1.0 - white);
  }
  result.q = s_vv - s_v1 * s_v1 / s_11;
  result.log_determinants += std::log(determinant) + std::log(s_11);
  return result;
}

/// 1ᵀV1/n²: variance of the plain mean.
double variance_of_mean(double n, double kept, double white) noexcept {
  const double lost = 1.0 - kept;
  const double pairs = kept * (n * lost - (1.0 - std::pow(kept, n))) / (lost * lost);
  return (white * n + (1.0 - white) * (n + 2.0 * pairs)) / (n * n);
}

/// Square of the error of the mean, averaged over what the values may be.
double square_of_error(std::span<const double> values, double mean, double square_sum) noexcept {
  constexpr int kTimes = 16;
  constexpr double kShortest = 0.7;  // In values.
  constexpr std::array<double, 4> kWhite{0.0, 0.05, 0.2, 0.5};
  const auto n = static_cast<double>(values.size());
  const double of_white = square_sum / ((n - 1.0) * n);
  if (values.size() < kFewest || !(square_sum > 0.0)) return of_white;
  std::array<double, WanderingMean::kMost> about_zero{};
  for (std::size_t i = 0; i < values.size(); ++i) about_zero[i] = values[i] - mean;
  // ln of prior |V|^(−1/2) (1ᵀV⁻¹1)^(−1/2) q^(−(n−1)/2), over that of white noise.
  const double log_of_white = -0.5 * std::log(n) - 0.5 * (n - 1.0) * std::log(square_sum);
  const double prior = (1.0 - kPriorOfWhite) / kPriorOfWhite / (kTimes * kWhite.size());
  // In units of the largest weight so far, as their logarithms reach thousands.
  double largest = 0.0;
  double weights = 1.0;
  double sum = of_white;
  for (int i = 0; i < kTimes; ++i) {
    const double time = kShortest * std::pow(n / kShortest, i / (kTimes - 1.0));
    const double kept = std::exp(-1.0 / time);
    for (const double white : kWhite) {
      const auto [q, log_determinants] =
          likelihood_of(std::span{about_zero}.first(values.size()), kept, white);
      if (!(q > 0.0)) continue;
      const double weight =
          std::log(prior) - 0.5 * log_determinants - 0.5 * (n - 1.0) * std::log(q) - log_of_white;
      if (weight > largest) {
        weights *= std::exp(largest - weight);
        sum *= std::exp(largest - weight);
        largest = weight;
      }
      weights += std::exp(weight - largest);
      // The variance is one more number that the values tell, τ another.
      sum += std::exp(weight - largest) * q / (n - 3.0) * variance_of_mean(n, kept, white);
    }
  }
  return sum / weights;
}

}  // namespace

void WanderingMean::add(double value) noexcept {
  values_.add(value);
  block_.add(value);
  if (block_.count < static_cast<double>(block_size_)) return;
  blocks_[block_count_++] = block_.mean;
  block_ = {};
  if (block_count_ < kMost) return;
  block_count_ /= 2;
  block_size_ *= 2;
  for (std::size_t i = 0; i < block_count_; ++i) blocks_[i] = 0.5 * (blocks_[2 * i] + blocks_[2 * i + 1]);
}

double WanderingMean::error_of_mean() const noexcept {
  if (values_.count < 2.0) return 0.0;
  const std::span blocks = std::span{blocks_}.first(block_count_);
  RunningVariance of_blocks;
  for (const double block : blocks) of_blocks.add(block);
  return std::max(std::sqrt(square_of_error(blocks, of_blocks.mean, of_blocks.square_sum)),
                  values_.error_of_mean());
}

}  // namespace stickslip::signal
