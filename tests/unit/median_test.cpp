#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "core/signal/statistics.hpp"

namespace stickslip::signal {
namespace {

TEST(Median, OfAnEvenNumberIsTheUpper) {
  const std::vector<double> values{4.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(median_of(values.size(), [&](std::size_t i) { return values[i]; }), 3.0);
}

TEST(Median, OfMoreThanAreSortedIsTheSame) {
  constexpr std::uint64_t kSeed = 11;
  std::mt19937_64 engine{kSeed};
  std::normal_distribution<double> normal{0.0, 1.0};
  for (const double offset : {-100.0, 0.0, 100.0}) {
    for (const std::size_t count : {kMostSorted + 1, kMostSorted + 2}) {
      std::vector<double> values(count);
      for (double& value : values) value = offset + normal(engine);
      values[1] = std::numeric_limits<double>::infinity();
      values[2] = -0.0;
      values[3] = std::numeric_limits<double>::denorm_min();
      const double bisected = median_of(count, [&](std::size_t i) { return values[i]; });
      EXPECT_EQ(bisected, median(values)) << offset << ", " << count << ", seed " << kSeed;
    }
  }
  EXPECT_EQ(median_of(kMostSorted + 1, [](std::size_t) { return -3.5; }), -3.5);
}

TEST(Median, OfManyThatDifferInTheirLastBitsIsExact) {
  // More than are sorted begin with the same 48 bits.
  const std::size_t half = kMostSorted + 1;
  const double next = std::nextafter(1.0, 2.0);
  const auto value = [&](std::size_t i) { return i % 2 == 0 ? next : 1.0; };
  EXPECT_EQ(nth_of(2 * half, half - 1, value), 1.0);
  EXPECT_EQ(nth_of(2 * half, half, value), next);
}

TEST(Median, IsOneOfTheValuesInRisingOrder) {
  constexpr std::uint64_t kSeed = 12;
  std::mt19937_64 engine{kSeed};
  std::normal_distribution<double> normal{0.0, 1.0};
  for (const std::size_t count : {std::size_t{1000}, kMostSorted + 1}) {
    std::vector<double> values(count);
    for (double& value : values) value = normal(engine);
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const std::size_t place : {std::size_t{0}, count / 100, count - 1}) {
      EXPECT_EQ(nth_of(count, place, [&](std::size_t i) { return values[i]; }), sorted[place])
          << count << ", " << place << ", seed " << kSeed;
    }
  }
}

}  // namespace
}  // namespace stickslip::signal
