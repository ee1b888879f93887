// The true scan rate from clock anchors.

#include "core/daq/rate_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/daq/rate_meter.hpp"

namespace stickslip::test {
namespace {

using daq::AnchorPicker;
using daq::ClockAnchor;
using daq::RateFit;
using daq::RateMeter;
using daq::ScanBlock;
using daq::ScanIndex;

constexpr double kGranted_Hz = 350.0;

std::int64_t time_of(ScanIndex scan, double rate_Hz, double late_ns = 0.0) {
  return 5'000'000'000 + std::llround(static_cast<double>(scan) * 1e9 / rate_Hz + late_ns);
}

TEST(RateFit, ExactAnchorsGiveTheRate) {
  RateFit fit{kGranted_Hz};
  for (ScanIndex scan = 0; scan < 7000; scan += 175) fit.add({scan, time_of(scan, 350.7), 0});
  const auto rate = fit.estimate();
  ASSERT_TRUE(rate);
  // Times are rounded to 1 ns over 20 s.
  EXPECT_NEAR(rate->rate_Hz, 350.7, 350.7 * 1e-10);
  EXPECT_LT(rate->standard_error_Hz, 350.7 * 1e-10);
  EXPECT_EQ(rate->anchor_count, 40);
}

TEST(RateFit, FewAnchorsGiveNone) {
  RateFit fit{kGranted_Hz};
  for (ScanIndex scan = 0; scan < 4; ++scan) fit.add({scan * 175, time_of(scan * 175, 350.0), 0});
  EXPECT_FALSE(fit.estimate());
  fit.add({4 * 175, time_of(4 * 175, 350.0), 0});
  EXPECT_TRUE(fit.estimate());
}

// Of a hundred seeded fits the deviation in standard errors must have the spread of Student's t with 38
// degrees of freedom: root mean square 1.027; 100 draws scatter about it by 1/sqrt(200) = 7 %, four times
// that is allowed.
TEST(RateFit, StandardErrorIsTheScatterOfTheFits) {
  std::mt19937_64 random{20'261'122};
  std::normal_distribution<double> late_ns{0.0, 50'000.0};
  double squares = 0.0;
  for (int trial = 0; trial < 100; ++trial) {
    RateFit fit{kGranted_Hz};
    for (ScanIndex scan = 0; scan < 7000; scan += 175) {
      fit.add({scan, time_of(scan, 350.05, late_ns(random)), 0});
    }
    const auto rate = fit.estimate();
    squares += std::pow((rate->rate_Hz - 350.05) / rate->standard_error_Hz, 2);
  }
  EXPECT_NEAR(std::sqrt(squares / 100.0), 1.027, 4.0 * 1.027 / std::sqrt(200.0));
}

// The index after an overrun comes from the clock at the granted rate; a line through both sides would be
// drawn towards that rate.
TEST(RateFit, EstimatedGapPartsTheAnchors) {
  std::vector<ClockAnchor> anchors;
  for (ScanIndex scan = 0; scan < 3500; scan += 175) anchors.push_back({scan, time_of(scan, 351.0), 0});
  for (ScanIndex scan = 3500; scan < 7000; scan += 175) {
    anchors.push_back({scan + 350'000, time_of(scan, 351.0) + 1'000'000'000'000, 0});
  }
  const daq::Gap gap{3400, 350'000, true, daq::GapCause::kOverrun};
  const auto parted = daq::fit_rate(anchors, {&gap, 1}, kGranted_Hz);
  ASSERT_TRUE(parted);
  EXPECT_NEAR(parted->rate_Hz, 351.0, 351.0 * 1e-9);
  daq::Gap counted = gap;
  counted.estimated = false;
  EXPECT_LT(daq::fit_rate(anchors, {&counted, 1}, kGranted_Hz)->rate_Hz, 350.1);
}

// A year at 350 Hz in blocks of a day: the sums must not lose the ppm.
TEST(RateFit, LongSessionsKeepTheirDigits) {
  RateFit fit{kGranted_Hz};
  constexpr ScanIndex kDay = 350LL * 86'400;
  for (ScanIndex day = 0; day < 365; ++day) fit.add({day * kDay, time_of(day * kDay, 350.00035), 0});
  EXPECT_NEAR(fit.estimate()->rate_Hz, 350.00035, 350.0 * 1e-12);
}

ScanBlock block(ScanIndex first, std::uint32_t count, double late_ns, bool prompt = true) {
  ScanBlock made;
  made.first = first;
  made.count = count;
  made.stamp = {time_of(first + count - 1, kGranted_Hz, late_ns), 0, prompt};
  return made;
}

TEST(AnchorPicker, LeastLateReadOfEachWindowIsTaken) {
  AnchorPicker picker{kGranted_Hz};
  std::vector<ClockAnchor> anchors;
  for (ScanIndex first = 0; first < 700; first += 5) {
    // Of each window of 175 scans the read that begins 100 scans in is prompt to 1 µs, the others late by 2
    // ms.
    const double late_ns = first % 175 == 100 ? 1e3 : 2e6;
    if (const auto anchor = picker.observe(block(first, 5, late_ns))) anchors.push_back(*anchor);
  }
  if (const auto anchor = picker.flush()) anchors.push_back(*anchor);
  ASSERT_EQ(anchors.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(anchors[i].scan, 104 + 175 * static_cast<ScanIndex>(i));
    EXPECT_EQ(anchors[i].monotonic_ns, time_of(anchors[i].scan, kGranted_Hz, 1e3));
  }
}

TEST(AnchorPicker, ReadsOfWhatHadPiledUpAreNoAnchors) {
  AnchorPicker picker{kGranted_Hz};
  for (ScanIndex first = 0; first < 700; first += 5) {
    EXPECT_FALSE(picker.observe(block(first, 5, 0.0, false)));
  }
  EXPECT_FALSE(picker.flush());
}

TEST(RateMeter, LatenessIsAgainstThePromptestRead) {
  RateMeter meter{kGranted_Hz};
  EXPECT_FALSE(meter.lateness_ns(block(0, 5, 0.0)));
  for (ScanIndex first = 0; first < 400; first += 5) meter.observe(block(first, 5, 10e3));
  EXPECT_NEAR(*meter.lateness_ns(block(400, 5, 510e3)), 500e3, 2.0);  // two roundings to 1 ns
}

TEST(RateMeter, ContinuationCountsByTheMeasuredRateOnceItIsKnown) {
  RateMeter meter{kGranted_Hz};
  EXPECT_FALSE(meter.continuation());
  for (ScanIndex first = 0; first < 7000; first += 5) {
    ScanBlock next = block(first, 5, 0.0);
    next.stamp.monotonic_ns = time_of(next.end() - 1, 351.0);
    meter.observe(next);
    if (first == 100) {
      EXPECT_EQ(meter.continuation()->scan_rate_Hz, kGranted_Hz);
    }
  }
  const auto from = meter.continuation();
  ASSERT_TRUE(from);
  EXPECT_NEAR(from->scan_rate_Hz, 351.0, 1e-6);
  EXPECT_EQ(from->end, 7000);
  EXPECT_EQ(daq::first_scan_after(*from, time_of(6999 + 351'000, 351.0)), 7000 + 351'000);
}

TEST(RateMeter, IndexNeverGoesBack) {
  const daq::Continuation from{500, {499, 10'000'000'000, 0}, 350.0};
  EXPECT_EQ(daq::first_scan_after(from, 10'000'000'000), 501);
  EXPECT_EQ(daq::first_scan_after(from, 1'000'000'000), 501);  // a clock that went back
}

}  // namespace
}  // namespace stickslip::test
