/// The measured traces, disturbed in ways that leave every slip where it is: the same slips are found.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/analysis/test_analysis.hpp"
#include "tests/support/measured_traces.hpp"
#include "tests/support/sanitized.hpp"

namespace stickslip::analysis {
namespace {

/// Rate of the original instrument [Penner 1995].
constexpr double kSlowRate_Hz = 350.0;

struct Course {
  std::vector<double> values;
  double rate_Hz = test::kMeasuredScanRate_Hz;
};

/// Scans nearest to the peaks.
std::vector<std::size_t> peaks_of(const Course& course) {
  AnalysisSettings settings;
  settings.scan_rate_Hz = course.rate_Hz;
  TestAnalysis analysis{settings};
  base::ScanIndex index = 0;
  for (const double value : course.values) analysis.add(index++, value, false);
  static_cast<void>(analysis.finish());
  std::vector<std::size_t> peaks;
  for (const detect::Cycle& cycle : analysis.cycles())
    peaks.push_back(static_cast<std::size_t>(cycle.first_scan));
  return peaks;
}

/// As a converter of that rate would have read it: the scan nearest to each of its instants. \param first  of
/// them.
Course decimated(const Course& course, double rate_Hz, std::size_t first) {
  Course slow;
  slow.rate_Hz = rate_Hz;
  for (std::size_t k = 0;; ++k) {
    const auto at =
        first + static_cast<std::size_t>(std::lround(static_cast<double>(k) * course.rate_Hz / rate_Hz));
    if (at >= course.values.size()) return slow;
    slow.values.push_back(course.values[at]);
  }
}

/// Single scans, both signs, not locked to anything, 20 a second and up to 0.37 high: as the sliding trace
/// has them by itself.
Course with_spikes(Course course, std::uint64_t seed) {
  constexpr double kRate_Hz = 20.0;
  std::mt19937_64 engine{seed};
  std::bernoulli_distribution hit{kRate_Hz / course.rate_Hz};
  std::uniform_real_distribution<double> height{-0.37, 0.37};
  for (double& value : course.values) {
    if (hit(engine)) value += height(engine);
  }
  return course;
}

struct MeasuredTrace {
  const char* file;
  const char* name;
};

class DisturbedTraces : public testing::TestWithParam<MeasuredTrace> {
 protected:
  void SetUp() override {
    whole_.values = test::measured_trace(GetParam().file);
    if (!whole_.values.empty()) {
      peaks_ = peaks_of(whole_);
      return;
    }
    if (test::measured_traces_required()) FAIL() << GetParam().file << " is required";
    GTEST_SKIP() << "there are no measured traces in " << test::measured_traces_folder();
  }

  /// Within 5 % of the undisturbed, which for few slips is none more and none less.
  void expect_as_many(const Course& course, const std::string& disturbance) {
    const std::size_t found = peaks_of(course).size();
    RecordProperty(disturbance, std::to_string(found) + " of " + std::to_string(peaks_.size()));
    EXPECT_NEAR(static_cast<double>(found), static_cast<double>(peaks_.size()),
                0.05 * static_cast<double>(peaks_.size()))
        << disturbance;
  }

  Course whole_;
  std::vector<std::size_t> peaks_;  ///< Of the undisturbed trace.
};

constexpr std::uint64_t kSeeds = test::kSanitized ? 1 : 5;
constexpr std::size_t kStarts = test::kSanitized ? 1 : 6;  // 5.7 scans become one.

TEST_P(DisturbedTraces, At350Hz) {
  // The nearly sinusoidal one keeps 10 scans a cycle.
  for (std::size_t first = 0; first < kStarts; ++first) {
    expect_as_many(decimated(whole_, kSlowRate_Hz, first), "350_Hz_from_scan_" + std::to_string(first));
  }
}

TEST_P(DisturbedTraces, TwentySpikesASecond) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    expect_as_many(with_spikes(whole_, seed), "spikes_seed_" + std::to_string(seed));
  }
}

TEST_P(DisturbedTraces, ScaledAndMoved) {
  // Differences of values and ratios of them are what decides.
  for (const auto& [gain, offset] : {std::pair{1e-3, -2.0}, {0.3, 0.0}, {7.0, 0.5}, {1e4, -2.0}}) {
    if (test::kSanitized && gain != 7.0) continue;
    Course course = whole_;
    for (double& value : course.values) value = gain * (value + offset);
    EXPECT_EQ(peaks_of(course), peaks_) << "gain " << gain << ", offset " << offset;
  }
}

TEST_P(DisturbedTraces, CutAnywhere) {
  // A cut leaves the slips whose rise and fall lie inside as they are. At its begin one slip can have lost
  // its rise, and at its end one its trough: up to two fewer. A first fall of which only part of the rise is
  // seen can look like a slip: up to one more. The noise is measured inside the cut alone, and moves limits
  // with it: 5 % as above.
  constexpr std::uint64_t kSeed = 17;
  constexpr int kCuts = test::kSanitized ? 2 : 15;
  std::mt19937_64 engine{kSeed};
  std::uniform_int_distribution<std::size_t> place{0, whole_.values.size()};
  for (int cut = 0; cut < kCuts; ++cut) {
    const auto [first, end] = std::minmax({place(engine), place(engine)});
    const Course part{{whole_.values.begin() + static_cast<std::ptrdiff_t>(first),
                       whole_.values.begin() + static_cast<std::ptrdiff_t>(end)}};
    const auto inside = static_cast<double>(std::count_if(
        peaks_.begin(), peaks_.end(), [&, f = first, e = end](std::size_t at) { return at >= f && at < e; }));
    const auto found = static_cast<double>(peaks_of(part).size());
    EXPECT_GE(found, inside - 2.0 - 0.05 * inside)
        << "scans " << first << " to " << end << ", seed " << kSeed;
    EXPECT_LE(found, inside + 1.0 + 0.05 * inside)
        << "scans " << first << " to " << end << ", seed " << kSeed;
    RecordProperty("scans_" + std::to_string(first) + "_to_" + std::to_string(end),
                   fmt::format("{} of {}", found, inside));
  }
}

INSTANTIATE_TEST_SUITE_P(Measured, DisturbedTraces,
                         testing::Values(MeasuredTrace{test::kNearlySinusoidal, "nearly_sinusoidal"},
                                         MeasuredTrace{test::kSawTooth, "saw_tooth"},
                                         MeasuredTrace{test::kIrregularSliding, "irregular_sliding"}),
                         [](const auto& trace) { return trace.param.name; });

}  // namespace
}  // namespace stickslip::analysis
