// The table of live estimators: what it says of a peer whose answers are known, and the order of our own.

#include "core/accuracy/tiers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/manual_clock.hpp"

namespace {

using namespace stickslip;

/// S − K of the scene.
constexpr double kTruth = 0.05;
constexpr double kNsPerScan = 220.0;
/// Slips of a test.
constexpr double kCycles = 11.0;

/// Always 10 % too much, and 20 % more or less from cycle to cycle.
accuracy::Peer known_peer(std::vector<std::size_t>& scan_counts) {
  return {"known", [&scan_counts](std::span<const accuracy::TierScene> scenes) {
            std::vector<accuracy::PeerOutcome> outcomes;
            for (const accuracy::TierScene& scene : scenes) {
              scan_counts.push_back(scene.tests.front().size());
              outcomes.push_back({kNsPerScan, {0.9 * kTruth, 1.3 * kTruth, 0.9 * kTruth, 1.3 * kTruth}});
            }
            return base::Result<std::vector<accuracy::PeerOutcome>>{outcomes};
          }};
}

std::vector<accuracy::TierRow> rows_of(const std::vector<accuracy::TierRow>& rows, std::string_view name) {
  std::vector<accuracy::TierRow> found;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(found),
               [&](const accuracy::TierRow& row) { return row.estimator == name; });
  return found;
}

TEST(Tiers, SayOfAPeerWhatItsAnswersMean) {
  std::vector<std::size_t> scan_counts;
  const test::ManualClock clock;
  const auto rows = accuracy::compare_tiers(clock, known_peer(scan_counts));
  const auto peers = rows_of(rows, "known");
  const auto fits = rows_of(rows, "fit");
  ASSERT_EQ(peers.size(), scan_counts.size());
  ASSERT_EQ(fits.size(), peers.size());
  for (std::size_t i = 0; i < peers.size(); ++i) {
    EXPECT_NEAR(peers[i].bias, 0.1, 1e-12);
    // Four values 0.2 from their mean: √(4 · 0.04/3).
    EXPECT_NEAR(peers[i].deviation, 0.4 / std::numbers::sqrt3, 1e-12);
    // The bound is the scene's, the same for all.
    EXPECT_NEAR(peers[i].over_bound / peers[i].deviation, fits[i].over_bound / fits[i].deviation,
                1e-9 * peers[i].over_bound / peers[i].deviation);
    EXPECT_NEAR(peers[i].us_per_cycle, 1e-3 * kNsPerScan * static_cast<double>(scan_counts[i]) / kCycles,
                1e-9);
  }
}

TEST(Tiers, SayWhyAPeerHasNoNumbers) {
  const test::ManualClock clock;
  const accuracy::Peer absent{"absent", [](std::span<const accuracy::TierScene>) {
                                return base::Result<std::vector<accuracy::PeerOutcome>>{
                                    base::failure("not installed: it lies elsewhere")};
                              }};
  const auto peers = rows_of(accuracy::compare_tiers(clock, absent), "absent");
  ASSERT_FALSE(peers.empty());
  for (const accuracy::TierRow& row : peers) EXPECT_EQ(row.reason, "not installed: it lies elsewhere");
}

// The maximum is S + the overshoot of a sled that slips with the belt's speed: the amplitude is √(1 + Q²) (S
// − K) about K [2], 1.65 times at Q = 1.309, of which damping takes a few parts in a hundred. Who fits the
// closed form has no such bias, and no standard deviation below the bound, which 200 cycles tell to 5 %.
TEST(Tiers, AreAsGoodAsTheyCost) {
  std::vector<std::size_t> scan_counts;
  const test::ManualClock clock;
  const auto rows = accuracy::compare_tiers(clock, known_peer(scan_counts));
  const auto peaks = rows_of(rows, "raw maximum of the test");
  const auto vertices = rows_of(rows, "turning-points");
  const auto fits = rows_of(rows, "fit");
  ASSERT_EQ(peaks.size(), fits.size());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (fits[i].scan_rate_Hz < 350.0) continue;  // Too few a cycle for any.
    SCOPED_TRACE(fits[i].scan_rate_Hz);
    EXPECT_GT(peaks[i].bias, 0.5);
    EXPECT_LT(peaks[i].bias, 0.7);
    EXPECT_LT(std::abs(vertices[i].bias), 0.01);
    EXPECT_LT(std::abs(fits[i].bias), 0.01);
    EXPECT_LT(fits[i].deviation, vertices[i].deviation);
    EXPECT_GT(fits[i].over_bound, 1.0 - 3.0 * 0.05);
  }
}

}  // namespace
