#include "core/signal/level_positions.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace stickslip::signal {
namespace {

TEST(LevelPositions, LastAboveIsTheLastAndFirstBelowTheFirst) {
  LastAbove above;
  FirstBelow below;
  const double values[] = {5.0, 3.0, 4.0, 4.0, 1.0, 2.0, 2.0, 0.0, 1.0};
  std::size_t position = 10;
  for (const double value : values) {
    above.add(position, value);
    below.add(position, value);
    ++position;
  }
  EXPECT_EQ(above.find(5.0), std::nullopt);
  EXPECT_EQ(above.find(4.5), 10U);
  EXPECT_EQ(above.find(3.5), 13U);
  EXPECT_EQ(above.find(1.5), 16U);
  EXPECT_EQ(above.find(-1.0), 18U);
  EXPECT_EQ(below.find(0.0), std::nullopt);
  EXPECT_EQ(below.find(0.5), 17U);
  EXPECT_EQ(below.find(1.5), 14U);
  EXPECT_EQ(below.find(4.5), 11U);
  EXPECT_EQ(below.find(9.0), 10U);
  above.clear();
  below.clear();
  EXPECT_EQ(above.find(-9.0), std::nullopt);
  EXPECT_EQ(below.find(9.0), std::nullopt);
}

TEST(LevelPositions, LaterPartCountsBehindTheFirst) {
  LastAbove all;
  LastAbove part;
  all.add(0, 5.0);
  all.add(1, 2.0);
  part.add(2, 3.0);
  part.add(3, 1.0);
  EXPECT_EQ(all.find(0.5), 1U);
  all.take(part);
  EXPECT_EQ(all.find(2.5), 2U);
  EXPECT_EQ(all.find(4.0), 0U);
  EXPECT_EQ(all.find(0.5), 3U);
  EXPECT_EQ(part.find(-1.0), std::nullopt);
}

TEST(LevelPositions, FallOfAsManyValuesAsThereAreStepsIsExact) {
  LastAbove above;
  FirstBelow below;
  for (std::size_t k = 0; k < kMostSteps; ++k) {
    above.add(k, -static_cast<double>(k));
    below.add(k, -static_cast<double>(k));
  }
  for (std::size_t k = 0; k < kMostSteps; ++k) {
    const double between = -static_cast<double>(k) - 0.5;
    EXPECT_EQ(above.find(between), k);
    EXPECT_EQ(below.find(between + 1.0), k);
  }
}

TEST(LevelPositions, LongerFallIsKnownToASmallPartOfIt) {
  LastAbove above;
  FirstBelow below;
  constexpr std::size_t kLength = 1'000'000;
  for (std::size_t k = 0; k < kLength; ++k) {
    above.add(k, -static_cast<double>(k));
    below.add(k, -static_cast<double>(k));
  }
  // As derived at Stairs.
  constexpr std::size_t kBound = 2 * kLength / (kMostSteps - 2);
  bool merged = false;
  for (std::size_t k = 0; k < kLength; k += 997) {
    const double between = -static_cast<double>(k) - 0.5;
    const std::size_t last = above.find(between).value();
    const std::size_t first = below.find(between + 1.0).value();
    EXPECT_LE(last, k);
    EXPECT_LE(k - last, kBound);
    EXPECT_GE(first, k);
    EXPECT_LE(first - k, kBound);
    merged = merged || last != k;
  }
  EXPECT_TRUE(merged);  // else the test shows nothing
}

}  // namespace
}  // namespace stickslip::signal
