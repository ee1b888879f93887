// How slips end, at any scan rate and around gaps, where nothing is known of the tester.

#include "core/detect/slip_follower.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/detect/fall_finder.hpp"
#include "core/detect/slip_rule.hpp"
#include "tests/support/live_trials.hpp"

namespace stickslip::detect {
namespace {

using test::LiveScene;
using test::LiveTrial;

/// A slip as it was left.
struct Ended {
  bool decided;
  bool captured;
  LiveCycle slip;
};

/// Falls found and followed as core/detect/live_detector does it.
class Followed {
 public:
  Followed(const LiveScene& scene, estimate::SharedPrior prior, double sigma,
           EstimatorTier tier = EstimatorTier::kTurningPoints)
      : scan_s_(1.0 / scene.scan_rate_Hz),
        sigma_(sigma),
        follower_(tier, scene.scan_rate_Hz, std::move(prior)) {}

  void add(double value) {
    const double now_s = time_s(position_);
    position_ += 1.0;
    follower_.add(now_s, value);
    const auto fall = finder_.add(value, SlipRule::kHysteresisSigmas * sigma_);
    if (finder_.falling())
      follower_.falls(time_s(static_cast<double>(finder_.high_at())),
                      time_s(static_cast<double>(finder_.low_at())));
    if (fall && rule_.is_slip(*fall, sigma_)) {
      force(true);
      follower_.open(*fall, time_s(fall->peak_at), time_s(fall->trough_at), sticks_, sigma_);
      return;
    }
    if (follower_.step(now_s, sigma_)) sticks_ = follower_.captured();
  }
  /// So many scans are missing.
  void gap(double count) {
    follower_.gap(time_s(position_ - 1.0));
    gap_at_ = position_;
    lost_ = count;
  }
  void end() { force(false); }

  [[nodiscard]] const std::vector<Ended>& slips() const { return slips_; }
  [[nodiscard]] const model::SharedParameters& shared() const { return follower_.shared(); }

 private:
  [[nodiscard]] double time_s(double position) const {
    return (position < gap_at_ ? position : position + lost_) * scan_s_;
  }
  void force(bool has_next) {
    if (!follower_.is_open()) return;
    (void)follower_.force(time_s(position_ - 1.0), sigma_, has_next);
    if (follower_.decided()) sticks_ = follower_.captured();
    slips_.push_back({follower_.decided(), follower_.captured(), follower_.slip()});
    follower_.close();
  }

  double scan_s_;
  double sigma_;
  SlipFollower follower_;
  FallFinder finder_;
  SlipRule rule_;
  double position_ = 0.0;
  double gap_at_ = 0.0;
  double lost_ = 0.0;
  bool sticks_ = true;
  std::vector<Ended> slips_;
};

Followed follow(const LiveScene& scene, estimate::SharedPrior prior,
                EstimatorTier tier = EstimatorTier::kTurningPoints) {
  LiveTrial trial{scene};
  Followed followed{scene, std::move(prior), scene.sigma, tier};
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) followed.add(trial.next());
  followed.end();
  return followed;
}

/// A sled on a belt whose speed may change at any time: c″ + γ c′ + ω₀² (c − K) = 0 while it slips, and it
/// sticks from where c′ has risen to the belt's rate until the force is S. In steps of a hundredth of a scan.
class Sled {
 public:
  explicit Sled(const LiveScene& scene) : scene_(scene), engine_(scene.seed) {}

  /// The next scan. \param r  of the belt, 1/s.
  [[nodiscard]] double scan(double r) {
    constexpr int kSteps = 100;
    const model::SharedParameters shared = scene_.shared();
    const double omega0_squared = shared.oscillator().omega0_squared();
    const double step_s = 1.0 / (scene_.scan_rate_Hz * kSteps);
    // The sled's own speed does not change at once with that of the belt.
    if (slips_) rate_ += r - belt_;
    belt_ = r;
    for (int i = 0; i < kSteps; ++i, time_s_ += step_s) {
      if (!slips_) {
        value_ += r * step_s;
        if (value_ < scene_.S) continue;
        slips_ = true;
        rate_ = r;
        onset_s_ = time_s_;
        continue;
      }
      rate_ -= (shared.gamma * rate_ + omega0_squared * (value_ - scene_.K)) * step_s;
      value_ += rate_ * step_s;
      if (rate_ < r || time_s_ < onset_s_ + 0.25 / scene_.frequency_Hz) continue;
      slips_ = false;
      capture_s_ = time_s_;
    }
    return value_ + scene_.sigma * noise_(engine_);
  }
  [[nodiscard]] double capture_s() const { return capture_s_; }  ///< The latest one.

 private:
  LiveScene scene_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> noise_;
  double time_s_ = 0.0;
  double value_ = 0.0;
  double rate_ = 0.0;
  double belt_ = 0.0;
  bool slips_ = false;
  double onset_s_ = 0.0;
  double capture_s_ = 0.0;
};

// Without noise no residual has a likelihood: the ratio is NaN.
TEST(SlipFollower, AnEndOfWhichTheScansTellNothingStaysUndecided) {
  LiveScene scene;
  scene.sigma = 0.0;
  const Followed followed = follow(scene, scene.characterised());
  ASSERT_GE(followed.slips().size(), 9U);
  for (const Ended& slip : followed.slips())
    EXPECT_TRUE(!slip.decided || slip.captured) << slip.slip.evidence;
}

// Few and many scans a cycle, slow and quick oscillations; nothing is known of the tester.
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

// Scans are missing, from any moment of a cycle on: that costs the ends of the slips whose scans they were,
// and nothing is learnt of the fall that they lie in. (With an unknown tester a fall that seems to take as
// long as the gap would teach a slow oscillation.)
TEST(SlipFollower, AGapCostsTheSlipsItIsInAlone) {
  for (const double scan_rate_Hz : {350.0, 10'000.0}) {
    for (const double lost_s : {0.02, 0.17}) {
      for (int eighth = 0; eighth < 8; ++eighth) {
        LiveScene scene;
        scene.scan_rate_Hz = scan_rate_Hz;
        LiveTrial trial{scene};
        constexpr std::size_t kTorn = 4;
        const double cycle_s = trial.slips()[kTorn + 1].onset_s - trial.slips()[kTorn].onset_s;
        const double gap_s = trial.slips()[kTorn].onset_s + eighth / 8.0 * cycle_s;
        Followed followed{scene, {}, scene.sigma};
        bool torn = false;
        for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) {
          const double value = trial.next();
          if (trial.time_s(scan) > gap_s && trial.time_s(scan) < gap_s + lost_s) continue;
          if (trial.time_s(scan) > gap_s && !torn) {
            followed.gap(std::floor(lost_s * scan_rate_Hz));
            torn = true;
          }
          followed.add(value);
        }
        const double untouched_from_s = gap_s + lost_s + cycle_s;
        int decided = 0;
        for (const Ended& slip : followed.slips()) {
          const double peak_s = slip.slip.cycle.peak_time_s;
          const bool untouched = peak_s < gap_s - cycle_s || peak_s > untouched_from_s;
          EXPECT_TRUE(!untouched || slip.decided)
              << scan_rate_Hz << ", " << lost_s << ", " << eighth << ": " << peak_s;
          EXPECT_TRUE(!slip.decided || slip.captured)
              << scan_rate_Hz << ", " << lost_s << ", " << eighth << ": " << peak_s;
          decided += slip.decided ? 1 : 0;
        }
        // Three of ten or so at most: before, in and behind the gap, and those of which nothing came.
        EXPECT_GE(decided, scene.slips - 2 - 3 - static_cast<int>(lost_s / cycle_s))
            << scan_rate_Hz << ", " << lost_s << ", " << eighth;
        EXPECT_NEAR(followed.shared().omega, scene.omega(), 0.05 * scene.omega())
            << scan_rate_Hz << ", " << lost_s << ", " << eighth;
      }
    }
  }
}

/// Pulls of one sled, scan by scan, followed.
class Pulled {
 public:
  Pulled(const LiveScene& scene, EstimatorTier tier, estimate::SharedPrior prior)
      : scene_(scene), sled_(scene), followed_(scene, std::move(prior), scene.sigma, tier) {}

  /// \param Q  of the belt; 0: it stands.
  Pulled& pull(double Q, double seconds) {
    for (int k = 0; k < static_cast<int>(std::round(seconds * scene_.scan_rate_Hz)); ++k) push(Q, 0.0);
    return *this;
  }
  void push(double Q, double disturbance) {
    followed_.add(sled_.scan(Q * scene_.omega() * (scene_.S - scene_.K)) + disturbance);
  }
  void end() { followed_.end(); }
  [[nodiscard]] const Sled& sled() const { return sled_; }
  [[nodiscard]] const Followed& followed() const { return followed_; }
  [[nodiscard]] const std::vector<Ended>& slips() const { return followed_.slips(); }
  /// Estimated stick rate over that at a Q.
  [[nodiscard]] double rate_over(double Q) const {
    return followed_.shared().r / (Q * scene_.omega() * (scene_.S - scene_.K));
  }

 private:
  LiveScene scene_;
  Sled sled_;
  Followed followed_;
};

// Little noise: the first question decides. A free oscillation ends its rise of c′ three quarters of a period
// after the peak at the latest [20], and questions follow each other by 1/32 of a period.
TEST(SlipFollower, CapturesAreToldWhereAFreeOscillationEndsItsRise) {
  LiveScene scene;
  scene.scan_rate_Hz = 2000.0;
  scene.sigma = 1e-4;
  const Followed followed = follow(scene, scene.characterised());
  ASSERT_GE(followed.slips().size(), 9U);
  for (std::size_t i = 0; i + 1 < followed.slips().size(); ++i) {
    const LiveCycle& slip = followed.slips()[i].slip;
    const double periods = (slip.decided_time_s - slip.cycle.peak_time_s) * scene.frequency_Hz;
    EXPECT_GE(periods, 0.59) << i;  // ω is known to 1 %.
    EXPECT_LE(periods, 0.75 + 1.0 / 32.0) << i;
  }
}

// Much noise: who decides before the next slip comes, and before two and a half periods are over, has the
// evidence for one wrong end in ten thousand [Wald 1945].
TEST(SlipFollower, DecidesEarlyOnlyByTenThousandToOne) {
  const double promised = std::log(1e4);
  int early = 0;
  for (const double Q : {0.3, 0.8, 1.309, 1.7}) {
    for (const double sigma : {0.002, 0.004}) {
      LiveScene scene;
      scene.Q = Q;
      scene.sigma = sigma;
      scene.escape_Q = 2.2;
      const Followed followed = follow(scene, scene.characterised());
      for (std::size_t i = 0; i + 1 < followed.slips().size(); ++i) {
        const Ended& slip = followed.slips()[i];
        const double decided_s = slip.slip.decided_time_s;
        const double next_peak_s = followed.slips()[i + 1].slip.cycle.peak_time_s;
        const double waited_s = decided_s - slip.slip.cycle.peak_time_s;
        if (!slip.decided || decided_s > next_peak_s || waited_s * scene.frequency_Hz > 2.4) continue;
        ++early;
        EXPECT_GT(std::abs(slip.slip.evidence), promised) << Q << ", " << sigma << ": slip " << i;
      }
    }
  }
  EXPECT_GT(early, 50);
}

/// An escape by a faster belt, which slows down half a second later.
Pulled escape_and_slow_down(EstimatorTier tier, double slow_Q) {
  LiveScene scene;
  Pulled pulled{scene, tier, scene.characterised()};
  pulled.pull(0.0, 0.3).pull(1.3, 0.6).pull(2.8, 0.5);
  pulled.pull(slow_Q, 0.04);
  return pulled;
}
constexpr double kSlowFrom_s = 1.4;
constexpr double kTrue_delta_mu = 0.05;

// A swing of a free oscillation has no stick before it, and no S − K. What falls more than the oscillation
// could was stuck before: its stick rate is that of the rise before it, and where the stick began is unknown.
TEST(SlipFollower, ALargerFallThanAFreeOneBeginsFromStick) {
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    Pulled pulled = escape_and_slow_down(tier, 0.6);
    pulled.pull(0.6, 1.0).end();
    int free = 0;
    int stuck = 0;
    for (const Ended& slip : pulled.slips()) {
      const Cycle& cycle = slip.slip.cycle;
      if (cycle.peak_time_s < 0.95) continue;
      if (cycle.peak_time_s < kSlowFrom_s + 0.02) {
        ++free;
        EXPECT_FALSE(slip.captured) << name(tier) << ", " << cycle.peak_time_s;
        EXPECT_TRUE(std::isnan(cycle.delta_mu)) << name(tier) << ", " << cycle.peak_time_s;
        continue;
      }
      if (stuck++ == 0) {
        EXPECT_TRUE(std::isnan(cycle.stick_time_s)) << name(tier);
      }
      EXPECT_TRUE(slip.captured || &slip == &pulled.slips().back())
          << name(tier) << ", " << cycle.peak_time_s;
      // Turning points of 350 scans/s and 20 Hz.
      EXPECT_NEAR(cycle.delta_mu, kTrue_delta_mu, 0.1 * kTrue_delta_mu)
          << name(tier) << ", " << cycle.peak_time_s;
    }
    EXPECT_GE(free, 8) << name(tier);
    EXPECT_GE(stuck, 10) << name(tier);
  }
}

// The belt is so slow that the swing itself is captured: that is where the next stick begins.
TEST(SlipFollower, ASwingThatSticksIsCapturedWhereItSticks) {
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    Pulled pulled = escape_and_slow_down(tier, 0.3);
    const double capture_s = pulled.sled().capture_s();
    ASSERT_GT(capture_s, kSlowFrom_s);
    pulled.pull(0.3, 1.0).end();
    const auto swing = std::ranges::find_if(pulled.slips(), [](const Ended& slip) {
      return slip.slip.cycle.peak_time_s > 0.95 && slip.captured;
    });
    ASSERT_NE(swing, pulled.slips().end()) << name(tier);
    // The new speed begins in this swing, which is fitted with one: known to an eighth of a period.
    EXPECT_NEAR(swing->slip.cycle.capture_time_s, capture_s, 1.0 / 160.0) << name(tier);
    // From the third slip behind it on the new speed is known: the force climbs from K − (S − K) or so to S.
    for (auto slip = swing + 3; slip != pulled.slips().end(); ++slip) {
      EXPECT_NEAR(slip->slip.cycle.stick_time_s, 0.051, 0.003) << name(tier);
      EXPECT_NEAR(slip->slip.cycle.delta_mu, kTrue_delta_mu, 0.1 * kTrue_delta_mu) << name(tier);
    }
  }
}

// After a while both ends and the stick rate are right again, whatever is known beforehand.
TEST(SlipFollower, TheFitFollowsABeltOfAnotherSpeed) {
  for (const auto& [before_Q, after_Q] : {std::pair{0.5, 1.0}, std::pair{1.0, 0.5}, std::pair{0.5, 0.6}}) {
    for (const bool characterised : {true, false}) {
      const LiveScene scene;
      Pulled pulled{scene, EstimatorTier::kFit,
                    characterised ? scene.characterised() : estimate::SharedPrior{}};
      pulled.pull(0.0, 0.3).pull(before_Q, 1.5).pull(after_Q, 1.0).end();
      for (const Ended& slip : pulled.slips()) {
        const double peak_s = slip.slip.cycle.peak_time_s;
        // The slips about the change may end in any way.
        if ((peak_s > 1.75 && peak_s < 1.95) || &slip == &pulled.slips().back()) continue;
        EXPECT_TRUE(slip.captured) << before_Q << " to " << after_Q << ", " << peak_s;
        if (peak_s < 1.75 || peak_s > 2.2) {
          // Where there is an S − K, it is right.
          EXPECT_FALSE(std::abs(slip.slip.cycle.delta_mu - kTrue_delta_mu) > 0.1 * kTrue_delta_mu)
              << before_Q << " to " << after_Q << ", " << peak_s << ": " << slip.slip.cycle.delta_mu;
        }
      }
      EXPECT_NEAR(pulled.rate_over(after_Q), 1.0, 0.02) << before_Q << " to " << after_Q;
    }
  }
}

// A vibration of eight standard deviations that neither course describes: what looks like an escape may be
// neither, and takes evidence that grows with the square of the misfit.
TEST(SlipFollower, AVibrationIsNoEscape) {
  const LiveScene scene;
  Pulled pulled{scene, EstimatorTier::kTurningPoints, scene.characterised()};
  pulled.pull(0.0, 0.3);
  constexpr double kVibration_Hz = 33.0;
  const double height = 8.0 * scene.sigma;
  for (int k = 0; k < 1000; ++k) {
    const double time_s = k / scene.scan_rate_Hz;
    pulled.push(0.5, height * std::sin(2.0 * std::numbers::pi * kVibration_Hz * time_s));
  }
  pulled.end();
  EXPECT_GT(pulled.slips().size(), 40U);
  for (const Ended& slip : pulled.slips()) {
    EXPECT_TRUE(slip.captured || !slip.decided) << slip.slip.cycle.peak_time_s;
  }
}

TEST(SlipFollower, ABeltThatStopsInASlipIsNoEscape) {
  for (const EstimatorTier tier : {EstimatorTier::kTurningPoints, EstimatorTier::kFit}) {
    // From the capture before it on: in the stick, at the onset, before and behind the peak, in the fall.
    for (int scans = 10; scans < 34; scans += 2) {
      const LiveScene scene;
      Pulled pulled{scene, tier, scene.characterised()};
      pulled.pull(0.0, 0.3).pull(0.5, 1.0);
      const double capture_s = pulled.sled().capture_s();
      while (pulled.sled().capture_s() == capture_s) pulled.push(0.5, 0.0);
      for (int k = 0; k < scans; ++k) pulled.push(0.5, 0.0);
      pulled.pull(0.0, 0.5).end();
      ASSERT_FALSE(pulled.slips().empty());
      EXPECT_TRUE(pulled.slips().back().captured) << name(tier) << ", " << scans;
    }
  }
}

}  // namespace
}  // namespace stickslip::detect
