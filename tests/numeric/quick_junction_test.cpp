// The quick question beside what it stands for: least squares row by row, the exact capture, the fit of
// core/detect/live_captured_course, and the answers of core/detect/live_junction.

#include "core/detect/quick_junction.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include <Eigen/LU>
#include <Eigen/QR>

#include "core/detect/live_rows.hpp"
#include "core/estimate/cycle_buffer.hpp"
#include "core/model/capture.hpp"
#include "core/model/threshold.hpp"
#include "tests/support/model_course.hpp"
#include "tests/support/sample_limits.hpp"

namespace stickslip::detect {
namespace {

using test::ModelCourse;

constexpr double kScan_s = 1.0 / ModelCourse::kScanRate_Hz;
constexpr double kDeltaMu = ModelCourse::kS - ModelCourse::kK;
constexpr double kSigma = 0.001;
constexpr double kDecisive = 9.210340371976184;
const double kPeriod_s = 2.0 * std::numbers::pi / ModelCourse::kOmega;

/// The first slip of a course, scan by scan, to both questions.
class Asked {
 public:
  Asked(const ModelCourse& course, estimate::Trace trace, double sigma)
      : shared_(course.shared), trace_(std::move(trace)), sigma_(sigma) {
    const model::SlipModel model{course.shared, course.windows.front().slip, course.windows.front().captured};
    peak_s_ = ModelCourse::kFirstOnset_s + model.waveform().peak_time_s();
  }

  /// Until one answers that is neither "not yet" nor, if `beyond_doubt`, "doubt".
  QuickJunction::Answer until_answered(double most_periods, bool beyond_doubt = true) {
    quick_.emplace(kScan_s);
    bool open = false;
    auto answer = QuickJunction::Answer::kNotYet;
    for (std::size_t k = 0; k < trace_.size(); ++k) {
      const double time_s = trace_.time_s[k];
      if (time_s > peak_s_ + most_periods * kPeriod_s) break;
      quick_->add(trace_.value[k], trace_.usable[k] != 0);
      if (time_s < peak_s_ + 0.6 * kPeriod_s) continue;
      if (!open) quick_->open(time_s, peak_s_, ModelCourse::kK, shared_);
      open = true;
      answer = quick_->ask(sigma_, kDeltaMu, kDecisive);
      last_ = k;
      if (answer == QuickJunction::Answer::kCaptured || answer == QuickJunction::Answer::kFree) break;
      if (answer == QuickJunction::Answer::kDoubt && beyond_doubt) break;
    }
    return answer;
  }

  [[nodiscard]] const QuickJunction& quick() const { return *quick_; }
  [[nodiscard]] double peak_s() const { return peak_s_; }
  /// What the full question says of the scans from the peak to the last that was asked about.
  [[nodiscard]] JunctionEvidence in_full() const {
    estimate::CycleBuffer buffer;
    for (std::size_t k = 0; k <= last_; ++k) {
      if (trace_.usable[k] != 0) buffer.add(trace_.time_s[k], trace_.value[k]);
    }
    LiveJunction junction;
    return junction.ask(buffer.since(peak_s_), shared_, sigma_, kDeltaMu);
  }

 private:
  model::SharedParameters shared_;
  estimate::Trace trace_;
  double sigma_;
  double peak_s_;
  std::optional<QuickJunction> quick_;
  std::size_t last_ = 0;
};

/// Rows of scans, with the slip that begins at the first of them.
struct LaidOut {
  ScanRows rows{kScan_s};
  SlipRows slip;

  LaidOut(const std::vector<double>& values, const std::vector<bool>& usable, std::size_t scans_per_row,
          const model::SharedParameters& shared, double level) {
    rows.restart(scans_per_row);
    for (std::size_t k = 0; k < values.size(); ++k) rows.add(values[k], usable.empty() || usable[k]);
    EXPECT_TRUE(slip.begin(rows, static_cast<double>(values.size() - 1) * kScan_s, -0.5 * kScan_s, level,
                           shared));  // No doubt about which is the first.
    EXPECT_TRUE(slip.take(rows));
  }
};

TEST(SlipRows, FitIsThatOfLeastSquaresRowByRow) {
  const model::SharedParameters shared = ModelCourse::tester_at(1.3);
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    std::mt19937_64 engine{seed};
    std::normal_distribution<double> normal;
    const std::size_t size = 8 + seed;
    std::vector<double> values(size);
    std::vector<bool> usable(size);
    Eigen::MatrixX3d model(size, 3);
    Eigen::VectorXd right(size);
    for (std::size_t k = 0; k < size; ++k) {
      const double t = static_cast<double>(k) * kScan_s;
      const double decay = std::exp(-0.5 * shared.gamma * t);
      values[k] = 0.3 + 0.05 * normal(engine);
      usable[k] = k % 7 != seed % 7;
      const double weight = usable[k] ? 1.0 : 0.0;
      const auto row = static_cast<Eigen::Index>(k);
      model.row(row) = weight * Eigen::RowVector3d{1.0, decay * std::cos(shared.omega * t),
                                                   decay * std::sin(shared.omega * t)};
      right(row) = weight * (values[k] - 0.31);
    }
    const LaidOut laid_out{values, usable, 1, shared, 0.31};
    const auto fit = laid_out.slip.fit(size - 1);
    const Eigen::Vector3d best = model.colPivHouseholderQr().solve(right);
    // The sums lose twice the digits of the condition number, which is below 30 here.
    EXPECT_NEAR(fit.course.K, best[0], 1e-12) << seed;
    EXPECT_NEAR(fit.course.A, best[1], 1e-12) << seed;
    EXPECT_NEAR(fit.course.B, best[2], 1e-12) << seed;
    EXPECT_NEAR(fit.square_sum, (right - model * best).squaredNorm(), 1e-12) << seed;
    const Eigen::Vector3d d{0.3, -1.2, 0.7};
    const double variance = d.dot((model.transpose() * model).inverse() * d);
    EXPECT_NEAR(laid_out.slip.variance(size - 1, {d[0], d[1], d[2]}), variance, 1e-11) << seed;
  }
}

TEST(SlipRows, RowsOfSeveralScansFollowTheSameCourse) {
  const model::SharedParameters shared = ModelCourse::tester_at(1.3);
  const double fine_s = kPeriod_s / 400.0;
  ScanRows rows{fine_s};
  rows.restart(10);
  const auto course = [&](double t) {
    return 0.3 + std::exp(-0.5 * shared.gamma * t) *
                     (0.08 * std::cos(shared.omega * t) - 0.01 * std::sin(shared.omega * t));
  };
  for (int k = 0; k < 600; ++k) rows.add(course(k * fine_s), true);
  SlipRows slip;
  ASSERT_TRUE(slip.begin(rows, 599 * fine_s, -0.5 * fine_s, 0.3, shared));
  ASSERT_TRUE(slip.take(rows));
  const auto fit = slip.fit(slip.size() - 1);
  // The next order of the attenuation: (10 ω scan)⁴/1920 of the amplitude.
  const double bound = 0.08 * std::pow(10.0 * shared.omega * fine_s, 4.0) / 1920.0;
  EXPECT_LT(fit.square_sum / static_cast<double>(slip.size()), bound * bound);
  // And what the mean makes of the damping: (γ/2 row)²/24.
  const double damping = std::pow(0.5 * shared.gamma * rows.row_s(), 2.0) / 24.0;
  EXPECT_NEAR(std::hypot(fit.course.A, fit.course.B),
              std::hypot(0.08, 0.01) * std::exp(-0.5 * shared.gamma * slip.first_s()),
              2.0 * bound + 0.08 * damping);
}

TEST(QuickCapture, FindsTheExactCapture) {
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  // Beyond, c′ may be back below r before the next row.
  for (double part = 0.1; part < 0.97; part += 0.02) {
    const ModelCourse course = ModelCourse::captured(part * Q_th, 3);
    const model::SlipModel model{course.shared, course.windows.front().slip, true};
    const auto first = static_cast<std::size_t>(
        std::ceil((ModelCourse::kFirstOnset_s + model.waveform().peak_time_s()) / kScan_s));
    const auto capture_s = ModelCourse::kFirstOnset_s + model.capture_s();
    const auto end = static_cast<std::size_t>(capture_s / kScan_s) + 3;
    const std::vector<double> values{course.trace.value.begin() + static_cast<std::ptrdiff_t>(first),
                                     course.trace.value.begin() + static_cast<std::ptrdiff_t>(end)};
    const LaidOut laid_out{values, {}, 1, course.shared, ModelCourse::kK};
    const auto before = static_cast<std::size_t>(capture_s / kScan_s) - first;
    StickBegin found;
    ASSERT_EQ(find_stick(laid_out.slip, laid_out.slip.fit(before).course, found), Crossing::kThere) << part;
    EXPECT_EQ(found.row, before) << part;
    // The level is flat about the capture against the line of the stick: a moment that is off by (ω row)²/8
    // of a row, as a chord is, and then the square of that, does not count.
    const double after_s = static_cast<double>(first) * kScan_s + found.tau_s - capture_s;
    const double on_line = model.at(capture_s).value + course.shared.r * after_s;
    EXPECT_NEAR(found.level + ModelCourse::kK, on_line, 1e-4 * kDeltaMu) << part;
  }
}

TEST(QuickCapture, CostsWhatTheCapturedCourseCosts) {
  // Rows that no weight of Huber's touches: both are least squares of the same course.
  int compared = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const ModelCourse course = ModelCourse::captured(0.3 + 0.02 * static_cast<double>(seed), 3);
    const estimate::Trace trace = course.noisy(kSigma, seed);
    const model::SlipModel model{course.shared, course.windows.front().slip, true};
    const double peak_s = ModelCourse::kFirstOnset_s + model.waveform().peak_time_s();
    const auto first = static_cast<std::size_t>(std::ceil(peak_s / kScan_s));
    const double next_onset_s = course.windows[1].slip.onset_s;
    const auto end = std::min(static_cast<std::size_t>(next_onset_s / kScan_s) + 4, trace.size());
    std::vector<double> values;
    estimate::CycleBuffer buffer;
    for (std::size_t k = first; k < end; ++k) {
      values.push_back(trace.value[k]);
      buffer.add(static_cast<double>(k - first) * kScan_s, trace.value[k]);
    }
    const LaidOut laid_out{values, {}, 1, course.shared, ModelCourse::kK};
    QuickCapture quick;
    const auto guess =
        static_cast<std::size_t>((ModelCourse::kFirstOnset_s + model.capture_s()) / kScan_s) - first;
    ASSERT_EQ(quick.start(laid_out.slip, guess, kDeltaMu, kSigma * kSigma), Crossing::kThere) << seed;
    quick.improve(laid_out.slip, 0.0);

    LiveRows rows;
    (void)rows.lay_out(buffer.points(), course.shared, kSigma);
    LiveFreeCourse free = LiveFreeCourse::Zero();
    (void)fit_free(rows.all().first(guess), free);
    LiveCapturedCourse::Parameters p;
    p << free, free[0] + kDeltaMu;
    const LiveCapturedCourse start{p, course.shared};
    const FittedCapture full = fit_captured({start, start.equations(rows.all(), kDeltaMu)}, rows.all(),
                                            course.shared, kDeltaMu, kSigma);
    bool weighted = false;
    for (const LiveRow& row : rows.all())
      weighted = weighted || std::abs(full.course.residual(row)) > kChoiceLimit;
    if (weighted) continue;
    ++compared;
    // What the steps of both leave.
    EXPECT_NEAR(quick.cost(), full.equations.cost, 0.15) << seed;
    EXPECT_NEAR(quick.stick().tau_s, full.course.capture_tau_s(), 1e-4) << seed;
  }
  EXPECT_GE(compared, 40);
}

TEST(QuickJunction, AnswersAsTheFullQuestionDoes) {
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  int clear = 0;
  int answered = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const double part = 0.3 + 0.006 * static_cast<double>(seed);
    const bool sticks = part < 0.97;
    if (!sticks && part < 1.03) continue;
    const ModelCourse course =
        sticks ? ModelCourse::captured(part * Q_th, 3) : ModelCourse::free(part * Q_th, 3.0);
    Asked asked{course, course.noisy(kSigma, seed), kSigma};
    const QuickJunction::Answer answer = asked.until_answered(1.3);
    const bool decided = answer == QuickJunction::Answer::kCaptured || answer == QuickJunction::Answer::kFree;
    if (part < 0.9 || part > 1.3) {
      ++clear;
      answered += decided ? 1 : 0;
    }
    if (!decided) continue;
    EXPECT_EQ(answer == QuickJunction::Answer::kCaptured, sticks) << part;
    const JunctionEvidence quick = asked.quick().evidence();
    const JunctionEvidence full = asked.in_full();
    EXPECT_GT(std::abs(quick.log_likelihood_ratio), kDecisive) << part;
    EXPECT_EQ(full.log_likelihood_ratio > 0.0, sticks) << part;
    if (sticks) {
      EXPECT_NEAR(quick.capture_s, full.capture_s, 0.5 * kScan_s) << part;
    }
  }
  // Not by being silent: what is not close to the threshold is left to the full question only where a scan is
  // far off, and 3 σ is one of 370, 20 of which make a slip: one slip in twenty.
  EXPECT_GE(answered, test::lowest_count(clear, 0.95));
}

TEST(QuickJunction, OneStrayScanDecidesNothing) {
  const double Q_th = model::Q_threshold(ModelCourse::kGammaOver2Omega);
  std::mt19937_64 engine{7};
  std::uniform_int_distribution<std::size_t> behind{11, 18};
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const ModelCourse course = ModelCourse::free(1.1 * Q_th, 2.0);
    estimate::Trace trace = course.noisy(kSigma, seed);
    const auto peak = static_cast<std::size_t>(std::ceil(ModelCourse::kFirstOnset_s / kScan_s)) + 3;
    trace.value[peak + behind(engine)] += (seed % 2 == 0 ? 6.0 : -6.0) * kSigma;
    Asked asked{course, trace, kSigma};
    EXPECT_NE(asked.until_answered(1.2, false), QuickJunction::Answer::kCaptured) << seed;
  }
}

TEST(QuickJunction, ScansThatAreNotUsableDoNotCount) {
  const ModelCourse course = ModelCourse::captured(1.3, 3);
  estimate::Trace trace = course.noisy(kSigma, 3);
  for (std::size_t k = 30; k < trace.size(); k += 6) {
    trace.value[k] = 5.0;
    trace.usable[k] = 0;
  }
  Asked asked{course, trace, kSigma};
  EXPECT_EQ(asked.until_answered(1.3), QuickJunction::Answer::kCaptured);
}

TEST(QuickJunction, DoubtsWithoutTheScansOfASlip) {
  QuickJunction quick{kScan_s};
  EXPECT_EQ(quick.ask(kSigma, kDeltaMu, kDecisive), QuickJunction::Answer::kDoubt);
  const ModelCourse course = ModelCourse::captured(1.3, 3);
  for (std::size_t k = 0; k < 34; ++k) quick.add(course.trace.value[k], true);
  // A slip that began before what is there; and one whose scans are cut off by a gap.
  const double now_s = course.trace.time_s[33];
  quick.open(now_s, -1.0, ModelCourse::kK, course.shared);
  EXPECT_EQ(quick.ask(kSigma, kDeltaMu, kDecisive), QuickJunction::Answer::kDoubt);
  quick.open(now_s, course.trace.time_s[24], ModelCourse::kK, course.shared);
  EXPECT_EQ(quick.ask(kSigma, kDeltaMu, kDecisive), QuickJunction::Answer::kNotYet);
  quick.gap();
  EXPECT_EQ(quick.ask(kSigma, kDeltaMu, kDecisive), QuickJunction::Answer::kDoubt);
}

// Rows asked for by and by are the rows asked for at once.
TEST(SlipRows, TakesThoseBeforeAMomentAndTheOthersLater) {
  const model::SharedParameters shared = ModelCourse::tester_at(1.3);
  ScanRows rows{kScan_s};
  for (int k = 0; k < 40; ++k) rows.add(0.3 + 0.01 * k * (k % 3), k % 11 != 5);
  const double now_s = 39.0 * kScan_s;
  SlipRows at_once;
  ASSERT_TRUE(at_once.begin(rows, now_s, -0.5 * kScan_s, 0.3, shared));
  ASSERT_TRUE(at_once.take(rows));
  ASSERT_EQ(at_once.size(), 40U);
  SlipRows by_and_by;
  ASSERT_TRUE(by_and_by.begin(rows, now_s, -0.5 * kScan_s, 0.3, shared));
  for (const double scans : {-3.0, 17.5, 17.5, 12.0, 30.5}) {
    const std::size_t before = by_and_by.size();
    ASSERT_TRUE(by_and_by.take(rows, scans * kScan_s));
    // Never fewer than there were.
    EXPECT_EQ(by_and_by.size(), std::max(before, static_cast<std::size_t>(std::max(scans + 1.0, 0.0))))
        << scans;
  }
  ASSERT_TRUE(by_and_by.take(rows));
  ASSERT_EQ(by_and_by.size(), at_once.size());
  for (const std::size_t k : {10U, 17U, 31U, 39U}) {
    EXPECT_EQ(by_and_by.fit(k).square_sum, at_once.fit(k).square_sum) << k;
    EXPECT_EQ(by_and_by.fit(k).course.B, at_once.fit(k).course.B) << k;
  }
}

// Of two junctions with the same scans the one that may look no further than a moment says what it would have
// said then.
TEST(QuickJunction, SaysLaterWhatItWouldHaveSaidThen) {
  const ModelCourse course = ModelCourse::captured(1.0, 3);
  const model::SlipModel model{course.shared, course.windows.front().slip, true};
  const double peak_s = ModelCourse::kFirstOnset_s + model.waveform().peak_time_s();
  const double until_s = peak_s + 1.1 * kPeriod_s;
  QuickJunction then{kScan_s};
  QuickJunction later{kScan_s};
  auto answer_then = QuickJunction::Answer::kDoubt;
  double last_s = 0.0;
  for (std::size_t k = 0; k < course.trace.size(); ++k) {
    last_s = course.trace.time_s[k];
    later.add(course.trace.value[k], true);
    if (last_s < until_s) then.add(course.trace.value[k], true);
    if (!(last_s < until_s) && answer_then == QuickJunction::Answer::kDoubt) {
      then.open(last_s - kScan_s, peak_s, ModelCourse::kK, course.shared);
      answer_then = then.ask(kSigma, kDeltaMu, kDecisive);
    }
  }
  later.open(last_s, peak_s, ModelCourse::kK, course.shared);
  const auto answer_later = later.ask(kSigma, kDeltaMu, kDecisive, until_s);
  ASSERT_EQ(answer_then, QuickJunction::Answer::kCaptured);
  ASSERT_EQ(answer_later, QuickJunction::Answer::kCaptured);
  EXPECT_EQ(later.evidence().log_likelihood_ratio, then.evidence().log_likelihood_ratio);
  EXPECT_NEAR(later.evidence().capture_s, then.evidence().capture_s, 1e-9);
}

// Without noise the sums lose all that is left.
TEST(SlipRows, LeaveNoLessThanNothing) {
  const model::SharedParameters shared = ModelCourse::tester_at(1.3);
  for (std::size_t size = 8; size < 60; ++size) {
    std::vector<double> values;
    for (std::size_t k = 0; k < size; ++k) {
      const double t = static_cast<double>(k) * kScan_s;
      values.push_back(0.3 + 0.08 * std::exp(-0.5 * shared.gamma * t) * std::cos(shared.omega * t + 0.1));
    }
    const LaidOut laid_out{values, {}, 1, shared, 0.3};
    EXPECT_GE(laid_out.slip.fit(size - 1).square_sum, 0.0) << size;
  }
}

TEST(QuickJunction, TellsWithoutNoiseToo) {
  for (const double Q : {0.65, 3.0}) {
    const ModelCourse course = Q < 1.9 ? ModelCourse::captured(Q, 3) : ModelCourse::free(Q, 3.0);
    Asked asked{course, course.trace, 1e-9};
    const auto answer = asked.until_answered(1.3, false);
    if (answer == QuickJunction::Answer::kCaptured || answer == QuickJunction::Answer::kFree) {
      EXPECT_EQ(answer == QuickJunction::Answer::kCaptured, Q < 1.9);
      EXPECT_TRUE(std::isfinite(asked.quick().evidence().residual_sigmas));
      EXPECT_TRUE(std::isfinite(asked.quick().evidence().log_likelihood_ratio));
    }
  }
}

/// Whether one slip after the other, each of another dimensionless speed, is called captured.
void expect_captured(QuickJunction& quick, double scan_s, double Q, double part_of_row) {
  const model::SharedParameters shared = ModelCourse::tester_at(Q);
  const model::SlipModel model{shared, {0.0, ModelCourse::kS, ModelCourse::kK}, true};
  const double peak_s = model.waveform().peak_time_s();
  const double first_s = peak_s + part_of_row * scan_s;
  std::mt19937_64 engine{5};
  std::normal_distribution<double> noise{0.0, kSigma};
  auto answer = QuickJunction::Answer::kNotYet;
  for (int k = 0; answer == QuickJunction::Answer::kNotYet && first_s + k * scan_s < peak_s + 1.5 * kPeriod_s;
       ++k) {
    const double time_s = first_s + k * scan_s;
    quick.add(model.at(time_s).value + noise(engine), true);
    if (k == 0) quick.open(time_s, peak_s, ModelCourse::kK, shared);
    answer = quick.ask(kSigma, kDeltaMu, kDecisive);
    if (time_s < peak_s + 0.6 * kPeriod_s) answer = QuickJunction::Answer::kNotYet;
  }
  EXPECT_EQ(answer, QuickJunction::Answer::kCaptured) << Q << ", " << part_of_row;
}

// A slow belt catches the sled just behind the trough, which lies anywhere between two rows.
TEST(QuickJunction, SeesACaptureNextToTheTrough) {
  const double scan_s = kPeriod_s / 24.0;
  for (const double Q : {0.05, 0.1, 0.2}) {
    for (const double part : {0.01, 0.3, 0.5, 0.8, 0.99}) {
      QuickJunction quick{scan_s};
      expect_captured(quick, scan_s, Q, part);
    }
  }
}

TEST(QuickJunction, ForgetsWhereTheLastSlipWasCaptured) {
  QuickJunction quick{kScan_s};
  for (const double Q : {1.5, 0.1, 1.5, 0.3, 1.3}) expect_captured(quick, kScan_s, Q, 0.5);
}

TEST(ScanRows, KeepsTheNewestAndSaysWhenTheyWere) {
  ScanRows rows{0.01};
  rows.restart(4);
  for (int k = 0; k < 4 * 300; ++k) rows.add(k, k != 4 * 290 + 1);
  EXPECT_EQ(rows.count(), 300U);
  EXPECT_EQ(rows[299].value, 4.0 * 299 + 1.5);
  EXPECT_EQ(rows[290].weight, 0.0);
  const double now_s = 0.01 * (4 * 300 - 1);
  EXPECT_NEAR(rows.newest_s(now_s), 0.01 * (4.0 * 299 + 1.5), 1e-12);
  std::vector<estimate::CyclePoint> points;
  rows.for_each_since(-1.0, now_s, [&](const estimate::CyclePoint& point) { points.push_back(point); });
  ASSERT_EQ(points.size(), ScanRows::kMost - 1);
  EXPECT_NEAR(points.front().first_s, 0.01 * 4 * 44, 1e-12);
  EXPECT_NEAR(points.front().last_s, 0.01 * (4 * 44 + 3), 1e-12);
  EXPECT_NEAR(points.front().spread_s2, 1.25e-4, 1e-12);
  points.clear();
  rows.for_each_since(0.01 * 4 * 298 - 1e-9, now_s,
                      [&](const estimate::CyclePoint& point) { points.push_back(point); });
  EXPECT_EQ(points.size(), 2U);
}

}  // namespace
}  // namespace stickslip::detect
