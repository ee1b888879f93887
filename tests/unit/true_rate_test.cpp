#include "core/pipeline/true_rate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace stickslip::pipeline {
namespace {

constexpr double kGrantedRate_Hz = 350.0;
constexpr int kAnchors = 40;
constexpr int kScansBetween = 175;

/// Results of clock readings at a rate that is off, each late or early by so much that the rate has this
/// relative standard error. The signs + − − + have no slope.
analysis::TestResults rate_of(double off, double relative_error) {
  constexpr double n = kAnchors;
  const double spread_scans = kScansBetween * std::sqrt(n * (n * n - 1.0) / 12.0);  // √Σ (i − ī)²
  const double period_ns = 1e9 / (kGrantedRate_Hz * (1.0 + off));
  const double late_ns = relative_error * spread_scans * period_ns * std::sqrt((n - 2.0) / n);
  std::vector<daq::ClockAnchor> anchors;
  for (int i = 0; i < kAnchors; ++i) {
    const double sign = i % 4 == 0 || i % 4 == 3 ? 1.0 : -1.0;
    anchors.push_back({i * kScansBetween, std::llround(i * kScansBetween * period_ns + sign * late_ns), 0});
  }
  analysis::TestResults results;
  add_true_rate(results, anchors, {}, kGrantedRate_Hz);
  return results;
}

// The computer's quartz may be off by 100 ppm: that much is uncertain, and a board that is off by less is no
// finding.
TEST(TrueRate, IsAsCertainAsTheClock) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_TRUE(rate_of(sign * 90e-6, 1e-7).findings.empty()) << sign;
    EXPECT_EQ(rate_of(sign * 110e-6, 1e-7).findings.size(), 1U) << sign;
  }
  const analysis::Estimate rate = rate_of(0.0, 1e-6).scan_rate_measured;
  ASSERT_TRUE(rate.value && rate.standard_error && rate.systematic_uncertainty);
  EXPECT_NEAR(*rate.value, kGrantedRate_Hz, 1e-6);
  EXPECT_NEAR(*rate.standard_error, 1e-6 * kGrantedRate_Hz, 0.01 * 1e-6 * kGrantedRate_Hz);
  EXPECT_NEAR(*rate.systematic_uncertainty, 100e-6 * kGrantedRate_Hz, 1e-9);
  EXPECT_EQ(rate.systematic_parts[analysis::UncertaintySource::kClock], rate.systematic_uncertainty);
}

TEST(TrueRate, DeviationExceedsFiveStandardErrors) {
  EXPECT_TRUE(rate_of(4.9 * 50e-6, 50e-6).findings.empty());
  EXPECT_EQ(rate_of(5.1 * 50e-6, 50e-6).findings.size(), 1U);
}

TEST(TrueRate, FewReadingsGiveAReason) {
  analysis::TestResults results;
  add_true_rate(results, std::vector<daq::ClockAnchor>{{0, 0, 0}, {175, 500'000'000, 0}}, {},
                kGrantedRate_Hz);
  EXPECT_FALSE(results.scan_rate_measured.value);
  EXPECT_FALSE(results.scan_rate_measured.reason.empty());
}

}  // namespace
}  // namespace stickslip::pipeline
