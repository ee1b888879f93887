/// \file
/// Random histories of a tester for its control charts: tests until a false alarm, and until a shift is told.
/// The seven quantities have different distributions, as those of real tests: normal, skewed, with heavy
/// tails, and counts that are mostly zero.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "core/trend/tester_charts.hpp"

namespace stickslip::test {

/// Standard deviations of a shift in one quantity; absent: in control.
struct TrendShift {
  trend::Quantity quantity = trend::Quantity::kZero;
  double standard_deviations = 1.0;
};

class RandomHistory {
 public:
  explicit RandomHistory(std::uint64_t seed) : random_(seed) {}

  trend::TestValues next(const std::optional<TrendShift>& shift = {}) {
    trend::TestValues test;
    test.sample = "reference";
    for (std::size_t i = 0; i < trend::kQuantities; ++i) {
      const auto quantity = static_cast<trend::Quantity>(i);
      const bool shifted = shift && shift->quantity == quantity;
      test.values[i] = draw(quantity, shifted ? shift->standard_deviations : 0.0);
    }
    test.delta_mu = test.values[0];
    return test;
  }

  /// A value of one quantity: standard deviations from its mean, spikes per scan.
  /// \param shift  in standard deviations. Of spikes it is a higher mean count.
  double draw(trend::Quantity quantity, double shift) {
    using enum trend::Quantity;
    switch (quantity) {
      case kDamping:
        return std::log(gamma_(random_) / kShape) * std::sqrt(kShape) + shift;
      case kZero:
        return heavy_(random_) / kHeavySd + shift;
      case kNoise:
        return (std::sqrt(variance_(random_) / (0.5 * kIdleScans)) - 1.0) * std::sqrt(2.0 * kIdleScans) +
               shift;
      case kSpikes:
        return spikes_(random_, decltype(spikes_)::param_type{mean_spikes(shift)}) / kScans;
      default:
        return normal_(random_) + shift;
    }
  }

  /// ln of the likelihood of a value with that shift, over its likelihood without.
  static double log_likelihood_ratio(trend::Quantity quantity, double value, double shift) {
    using enum trend::Quantity;
    const auto of_shift = [&](auto&& log_density) { return log_density(value - shift) - log_density(value); };
    switch (quantity) {
      case kDamping:
        return of_shift([](double x) {
          const double log_gamma = x / std::sqrt(kShape);
          return kShape * (log_gamma - std::exp(log_gamma));
        });
      case kZero:
        return of_shift([](double x) {
          return -0.5 * (kFreedom + 1.0) * std::log1p(x * kHeavySd * x * kHeavySd / kFreedom);
        });
      case kNoise:
        return of_shift([](double x) {
          const double sd = 1.0 + x / std::sqrt(2.0 * kIdleScans);
          return (kIdleScans - 1.0) * std::log(sd) - 0.5 * kIdleScans * sd * sd;
        });
      case kSpikes:
        return value * kScans * std::log(mean_spikes(shift) / kSpikesInControl) -
               (mean_spikes(shift) - kSpikesInControl);
      default:
        return of_shift([](double x) { return -0.5 * x * x; });
    }
  }

 private:
  static constexpr double kShape = 20.0;             ///< Of gamma: damping is the log of such a value.
  static constexpr double kFreedom = 5.0;            ///< Of Student's t: the zero.
  static constexpr double kIdleScans = 700.0;        ///< The noise is the standard deviation of 2 s at rest.
  static constexpr double kScans = 3500.0;           ///< In a test of 10 s.
  static constexpr double kSpikesInControl = 0.105;  ///< In a test on average; nine of ten tests have none.
  inline static const double kHeavySd = std::sqrt(kFreedom / (kFreedom - 2.0));

  static double mean_spikes(double shift) { return kSpikesInControl + shift * std::sqrt(kSpikesInControl); }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::gamma_distribution<double> gamma_{kShape};
  std::gamma_distribution<double> variance_{0.5 * kIdleScans};
  std::student_t_distribution<double> heavy_{kFreedom};
  std::poisson_distribution<int> spikes_;
};

/// Tests from an empty history to the first alarm of any chart.
inline std::int64_t tests_to_false_alarm(std::uint64_t seed) {
  RandomHistory history{seed};
  trend::TesterCharts charts{"reference"};
  std::int64_t count = 1;
  while (charts.add(history.next()).empty()) ++count;
  return count;
}

/// Tests after the shift to its alarm, at most `most`; absent: a false alarm came before the shift.
inline std::optional<std::int64_t> tests_to_alarm(std::uint64_t seed, std::int64_t before,
                                                  const TrendShift& shift, std::int64_t most = 1000) {
  RandomHistory history{seed};
  trend::TesterCharts charts{"reference"};
  for (std::int64_t i = 0; i < before; ++i) charts.add(history.next());
  if (charts.state(shift.quantity).alarm) return std::nullopt;
  for (std::int64_t count = 1; count < most; ++count) {
    charts.add(history.next(shift));
    if (charts.state(shift.quantity).alarm) return count;
  }
  return most;
}

}  // namespace stickslip::test
