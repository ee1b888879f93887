#include "core/friction/test_analysis.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "tests/support/allocation_count.hpp"

namespace stickslip::friction {
namespace {

TEST(TestAnalysis, AddsAScanWithoutAllocatingUntilABlockIsFull) {
  std::mt19937_64 engine{4};
  std::normal_distribution<double> normal{0.3, 0.001};
  TestAnalysis analysis{AnalysisSettings{}};
  analysis.add(0, 0.3, false);  // takes the first block of each column
  const std::uint64_t before = test::allocation_count();
  constexpr auto kBlock = static_cast<base::ScanIndex>(base::LongColumn<double>::kBlock);
  for (base::ScanIndex scan = 1; scan < kBlock; ++scan) analysis.add(scan, normal(engine), false);
  EXPECT_EQ(test::allocation_count(), before);
  analysis.add(kBlock, 0.3, false);
  EXPECT_GT(test::allocation_count(), before);  // else the test shows nothing
}

}  // namespace
}  // namespace stickslip::friction
