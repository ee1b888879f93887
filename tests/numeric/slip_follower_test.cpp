// How slips end with the tradition, which keeps no scans: by heights, by rows that are asked late, and by
// what a slip that had to be asked in full teaches of the tester.

#include "core/friction/slip_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/friction/fall_finder.hpp"
#include "core/friction/slip_rule.hpp"
#include "tests/support/live_trials.hpp"

namespace stickslip::friction {
namespace {

using test::LiveScene;
using test::LiveTrial;

/// A slip as it was left.
struct Ended {
  bool decided;
  bool captured;
  LiveCycle slip;
};

/// Falls found and followed as core/friction/live_detector does it with the tradition.
class Followed {
 public:
  Followed(const LiveScene& scene, SharedPrior prior, double sigma)
      : scene_(scene), sigma_(sigma), follower_(EstimatorTier::kPeak, scene.scan_rate_Hz, std::move(prior)) {}

  /// \param scan  its number.
  void add(std::int64_t scan, double value, bool usable = true) {
    const double now_s = static_cast<double>(scan) / scene_.scan_rate_Hz;
    follower_.add(value, usable);
    const auto fall = finder_.add(value, SlipRule::kHysteresisSigmas * sigma_);
    if (fall && rule_.is_slip(*fall, sigma_)) {
      end(now_s, &*fall);
      const double scan_s = 1.0 / scene_.scan_rate_Hz;
      follower_.open(*fall, fall->peak_at * scan_s, fall->trough_at * scan_s, now_s, sticks_, sigma_);
      return;
    }
    if (follower_.has_task()) (void)follower_.step(now_s, sigma_);
  }
  void end(double now_s, const Fall* next) {
    if (!follower_.is_open()) return;
    (void)follower_.force(now_s, sigma_, next);
    if (follower_.decided()) sticks_ = follower_.captured();
    slips_.push_back({follower_.decided(), follower_.captured(), follower_.slip()});
    follower_.close();
  }
  /// \param scan  number of the last one before.
  void gap(std::int64_t scan) {
    if (follower_.gap(static_cast<double>(scan) / scene_.scan_rate_Hz, sigma_))
      sticks_ = follower_.captured();
  }

  [[nodiscard]] const std::vector<Ended>& slips() const { return slips_; }
  [[nodiscard]] const SharedParameters& shared() const { return follower_.shared(); }

 private:
  LiveScene scene_;
  double sigma_;
  SlipFollower follower_;
  FallFinder finder_;
  SlipRule rule_;
  bool sticks_ = true;
  std::vector<Ended> slips_;
};

Followed follow(const LiveScene& scene, SharedPrior prior) {
  LiveTrial trial{scene};
  Followed followed{scene, std::move(prior), scene.sigma};
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) followed.add(scan, trial.next());
  followed.end(trial.time_s(trial.scan_count()), nullptr);
  return followed;
}

// Rates with one scan a row and with many, oscillations for which the first rows were far too long; nothing
// known of the tester.
TEST(SlipFollower, TellsCapturesFromAnEscapeWhateverTheRate) {
  const std::vector<std::pair<double, double>> rates{{100.0, 5.0},   {350.0, 20.0},    {1000.0, 10.0},
                                                     {1000.0, 40.0}, {10'000.0, 20.0}, {100'000.0, 20.0}};
  for (const auto& [scan_rate_Hz, frequency_Hz] : rates) {
    LiveScene scene;
    scene.scan_rate_Hz = scan_rate_Hz;
    scene.frequency_Hz = frequency_Hz;
    scene.escape_Q = 3.0;
    const Followed followed = follow(scene, {});
    const auto captures = static_cast<std::size_t>(scene.slips);
    ASSERT_GT(followed.slips().size(), captures + 1) << scan_rate_Hz;
    for (std::size_t i = 0; i + 1 < followed.slips().size(); ++i) {
      const Ended& slip = followed.slips()[i];
      EXPECT_TRUE(slip.decided) << scan_rate_Hz << ", " << frequency_Hz << ": slip " << i;
      EXPECT_EQ(slip.captured, i < captures) << scan_rate_Hz << ", " << frequency_Hz << ": slip " << i;
    }
  }
}

// Many scans do not fit what is guessed of a tester. The first slip is then fitted, which tells ω to a few
// thousandths and γ/2ω to a third or so; turning points would leave γ/2ω at the paper's 0.022 for ever.
TEST(SlipFollower, LearnsTheTesterWhereScansDoNotFitIt) {
  for (const double gamma_over_2omega : {0.01, 0.05, 0.08}) {
    LiveScene scene;
    scene.scan_rate_Hz = 10'000.0;
    scene.gamma_over_2omega = gamma_over_2omega;
    scene.Q = 1.0;
    const Followed followed = follow(scene, {});
    // A window from the onset to the capture tells γ/2ω to 0.003 in one slip; four of these.
    EXPECT_NEAR(followed.shared().oscillator().gamma_over_2omega(), gamma_over_2omega, 0.012);
    EXPECT_NEAR(followed.shared().omega, scene.omega(), 0.01 * scene.omega());
  }
}

// Nothing but the heights: a spike sits in every row of a slip, but in no turning point. They say captured by
// more than 20 to 1 and less than 10⁴ to 1.
TEST(SlipFollower, HeightsDecideWhereNoScanTells) {
  LiveScene scene;
  scene.sigma = 0.0;
  LiveTrial trial{scene};
  constexpr std::size_t kBlind = 5;
  const double from_s = trial.slips()[kBlind].onset_s;
  const double to_s = trial.slips()[kBlind + 1].onset_s + 0.05;
  Followed followed{scene, scene.characterised(), 0.0035};
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) {
    const double time_s = trial.time_s(scan);
    followed.add(scan, trial.next(), time_s < from_s || time_s > to_s);
  }
  ASSERT_GT(followed.slips().size(), kBlind + 1);
  const Ended& blind = followed.slips()[kBlind];
  EXPECT_TRUE(blind.decided);
  EXPECT_TRUE(blind.captured);
  EXPECT_GT(blind.slip.evidence, std::log(20.0));
  EXPECT_LT(blind.slip.evidence, std::log(1e4));
  EXPECT_TRUE(std::isnan(blind.slip.cycle.capture_time_s));
}

// Scans are missing: of this slip nothing is said, and nothing that is NaN is learnt from it.
TEST(SlipFollower, AGapCostsTheSlipItIsInAlone) {
  for (const double scan_rate_Hz : {350.0, 10'000.0}) {
    LiveScene scene;
    scene.scan_rate_Hz = scan_rate_Hz;
    LiveTrial trial{scene};
    constexpr std::size_t kTorn = 4;
    const auto gap_at = static_cast<std::int64_t>((trial.slips()[kTorn].onset_s + 0.03) * scan_rate_Hz);
    Followed followed{scene, {}, scene.sigma};
    for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) {
      if (scan == gap_at) followed.gap(scan - 1);
      followed.add(scan, trial.next());
    }
    // The last one is under way, and perhaps its fall is not over.
    ASSERT_GE(followed.slips().size(), static_cast<std::size_t>(scene.slips - 2));
    for (std::size_t i = 0; i < followed.slips().size(); ++i) {
      EXPECT_EQ(followed.slips()[i].decided, i != kTorn) << scan_rate_Hz << ": slip " << i;
      EXPECT_EQ(followed.slips()[i].captured, i != kTorn) << scan_rate_Hz << ": slip " << i;
    }
    EXPECT_TRUE(std::isfinite(followed.shared().omega) && std::isfinite(followed.shared().gamma) &&
                std::isfinite(followed.shared().r));
  }
}

}  // namespace
}  // namespace stickslip::friction
