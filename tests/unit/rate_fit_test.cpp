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
    anchors.push_back({scan + 10'500, time_of(scan, 351.0) + 30'000'000'000, 0});
  }
  const daq::Gap gap{3400, 10'500, true, daq::GapCause::kOverrun};
  const auto parted = daq::fit_rate(anchors, {&gap, 1}, kGranted_Hz);
  ASSERT_TRUE(parted);
  EXPECT_NEAR(parted->rate_Hz, 351.0, 351.0 * 1e-9);
  daq::Gap counted = gap;
  counted.estimated = false;
  EXPECT_LT(daq::fit_rate(anchors, {&counted, 1}, kGranted_Hz)->rate_Hz, 350.6);
}

/// What the clock showed when the scan was read: at times that no stall [begin, end) of the reader holds.
/// What piled up in a stall is read at its end in a burst, half a second of scans in 10 µs.
std::vector<ClockAnchor> anchors_with_stalls(double rate_Hz, int count,
                                             const std::vector<std::pair<double, double>>& stalls_s,
                                             std::mt19937_64& random) {
  std::exponential_distribution<double> late_s{1.0 / 50e-6};
  std::vector<ClockAnchor> anchors;
  double read_s = 0.0;
  for (int i = 0; i < count; ++i) {
    const ScanIndex scan = 175 * i;
    double time_s = static_cast<double>(scan) / rate_Hz + late_s(random);
    for (const auto& [begin_s, end_s] : stalls_s) {
      if (time_s >= begin_s && time_s < end_s) time_s = end_s;
    }
    read_s = std::max(read_s + 10e-6, time_s);
    anchors.push_back({scan, 5'000'000'000 + std::llround(1e9 * read_s), 0});
  }
  return anchors;
}

// Stalls of 10 to 70 s anywhere, at the beginning and at the end of a test too, or longer than the test: a
// rate that is told is right within five of its standard errors.
TEST(RateFit, StallsGiveNoWrongRate) {
  std::mt19937_64 random{20'261'126};
  std::uniform_real_distribution<double> stall_s{10.0, 70.0};
  std::uniform_int_distribution<int> size{5, 240};
  std::uniform_real_distribution<double> ppm{-200.0, 200.0};
  int told = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const double rate_Hz = kGranted_Hz * (1.0 + 1e-6 * ppm(random));
    const int count = size(random);
    std::vector<std::pair<double, double>> stalls_s;
    for (int i = 0; i <= trial % 3; ++i) {
      const double begin_s = std::uniform_real_distribution<double>{-70.0, 0.5 * count}(random);
      stalls_s.emplace_back(begin_s, begin_s + stall_s(random));
    }
    const auto anchors = anchors_with_stalls(rate_Hz, count, stalls_s, random);
    const auto rate = daq::fit_rate(anchors, {}, kGranted_Hz);
    RateFit live{kGranted_Hz};
    for (const ClockAnchor& anchor : anchors) live.add(anchor);
    for (const auto& one : {rate, live.estimate()}) {
      if (!one) continue;
      ++told;
      // Sure beyond chance, with as few degrees of freedom as there are: what findings ask for and more.
      const bool far = std::abs(one->rate_Hz - rate_Hz) > 300e-6 * rate_Hz &&
                       std::abs(one->rate_Hz - rate_Hz) > 5.0 * one->standard_error_Hz;
      EXPECT_FALSE(far) << "trial " << trial << ": " << one->rate_Hz << " +- " << one->standard_error_Hz
                        << " Hz of " << one->anchor_count << " anchors, true " << rate_Hz;
      EXPECT_NEAR(one->rate_Hz, rate_Hz, 0.03 * rate_Hz) << "trial " << trial;
    }
  }
  EXPECT_GT(told, 1500);
}

TEST(RateFit, TestReadInOneBurstTellsNoRate) {
  std::mt19937_64 random{7};
  const auto anchors = anchors_with_stalls(kGranted_Hz, 20, {{-1.0, 60.0}}, random);
  EXPECT_FALSE(daq::fit_rate(anchors, {}, kGranted_Hz));
}

// The machine slept: the monotonic clock stood still while the board went on.
TEST(RateFit, ClockThatStoodStillPartsTheAnchors) {
  std::vector<ClockAnchor> anchors;
  for (ScanIndex scan = 0; scan < 7000; scan += 175) {
    const std::int64_t slept_ns = scan < 3500 ? 0 : 30'000'000'000;
    anchors.push_back({scan + (slept_ns == 0 ? 0 : 10'500), time_of(scan, 350.1), 0});
  }
  const auto rate = daq::fit_rate(anchors, {}, kGranted_Hz);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->rate_Hz, 350.1, 350.1 * 1e-9);
  EXPECT_EQ(rate->anchor_count, 40);
}

// A board that is far off is told, although no anchor keeps to the granted rate.
TEST(RateFit, BoardOfTwiceTheRateIsMeasured) {
  std::vector<ClockAnchor> anchors;
  for (ScanIndex scan = 0; scan < 3500; scan += 175) anchors.push_back({scan, time_of(scan, 700.0), 0});
  const auto rate = daq::fit_rate(anchors, {}, kGranted_Hz);
  ASSERT_TRUE(rate);
  EXPECT_NEAR(rate->rate_Hz, 700.0, 700.0 * 1e-9);
}

TEST(RateFit, LateAnchorDoesNotCountAndLineGoesOn) {
  RateFit fit{kGranted_Hz};
  for (ScanIndex scan = 0; scan < 7000; scan += 175) {
    const bool late = scan == 3500;
    EXPECT_EQ(fit.add({scan, time_of(scan, 350.0, late ? 300e6 : 0.0), 0}), !late);
  }
  EXPECT_EQ(fit.estimate()->anchor_count, 39);
  EXPECT_NEAR(fit.estimate()->rate_Hz, 350.0, 350.0 * 1e-10);
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

TEST(RateMeter, ScansThatWereNeverReadPromptlyContinueAllTheSame) {
  RateMeter meter{kGranted_Hz};
  for (ScanIndex first = 0; first < 700; first += 5) meter.observe(block(first, 5, 0.0, false));
  const auto from = meter.continuation();
  ASSERT_TRUE(from);
  EXPECT_EQ(from->end, 700);
  EXPECT_EQ(from->scan_rate_Hz, kGranted_Hz);
  // By the late read fewer scans are counted as lost, never none.
  EXPECT_EQ(from->anchor.scan, 699);
  EXPECT_EQ(daq::first_scan_after(*from, from->anchor.monotonic_ns + 2'000'000'000), 1400);
}

TEST(RateMeter, APromptReadCountsBeforeLaterOnesThatWereNot) {
  RateMeter meter{kGranted_Hz};
  meter.observe(block(0, 5, 0.0));
  meter.observe(block(5, 5, 1e9, false));
  ASSERT_TRUE(meter.continuation());
  EXPECT_EQ(meter.continuation()->anchor.scan, 4);
  EXPECT_EQ(meter.continuation()->end, 10);
}

TEST(RateMeter, IndexNeverGoesBack) {
  const daq::Continuation from{500, {499, 10'000'000'000, 0}, 350.0};
  EXPECT_EQ(daq::first_scan_after(from, 10'000'000'000), 501);
  EXPECT_EQ(daq::first_scan_after(from, 1'000'000'000), 501);  // a clock that went back
}

}  // namespace
}  // namespace stickslip::test
