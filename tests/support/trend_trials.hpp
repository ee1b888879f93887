/// \file
/// Random histories of a tester for its control charts: tests until a false alarm, and until a shift is told.
/// The seven quantities have different distributions, as those of real tests: normal, skewed, with heavy
/// tails, and counts that are mostly zero.
#pragma once

#include <array>
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

  /// Mean count of spikes in a test; nine of ten tests have none.
  static constexpr double kSpikes = 0.105;

  trend::TestValues next(const std::optional<TrendShift>& shift = {}) {
    trend::TestValues test;
    test.sample = "reference";
    const std::array<double, trend::kQuantities> unit{
        normal_(random_),
        normal_(random_),
        std::log(gamma_(random_) / kShape) * std::sqrt(kShape),  // Skewed, as the log of a variance.
        heavy_(random_) / std::sqrt(kFreedom / (kFreedom - 2.0)),
        gamma_(random_) / std::sqrt(kShape),
        (static_cast<double>(spikes_(random_)) - kSpikes) / std::sqrt(kSpikes),
        normal_(random_)};
    for (std::size_t i = 0; i < unit.size(); ++i) {
      const bool shifted = shift && shift->quantity == static_cast<trend::Quantity>(i);
      // More spikes are a higher mean count, not a fraction of a spike in each test.
      if (shifted && shift->quantity == trend::Quantity::kSpikes) {
        std::poisson_distribution<int> more{kSpikes + shift->standard_deviations * std::sqrt(kSpikes)};
        test.values[i] = more(random_) / kScans;
        continue;
      }
      if (i == static_cast<std::size_t>(trend::Quantity::kSpikes)) {
        test.values[i] = std::round(unit[i] * std::sqrt(kSpikes) + kSpikes) / kScans;
        continue;
      }
      test.values[i] = unit[i] + (shifted ? shift->standard_deviations : 0.0);
    }
    test.delta_mu = test.values[0];
    return test;
  }

 private:
  static constexpr double kShape = 20.0;   ///< Of gamma: the noise from some dozen effective scans.
  static constexpr double kFreedom = 5.0;  ///< Of Student's t.
  static constexpr double kScans = 3500.0;

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::gamma_distribution<double> gamma_{kShape};
  std::student_t_distribution<double> heavy_{kFreedom};
  std::poisson_distribution<int> spikes_{kSpikes};
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
