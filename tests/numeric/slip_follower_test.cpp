// How slips end, at any scan rate and around gaps, where nothing is known of the tester.

#include "core/detect/slip_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
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
  Followed(const LiveScene& scene, estimate::SharedPrior prior, double sigma)
      : scan_s_(1.0 / scene.scan_rate_Hz),
        sigma_(sigma),
        follower_(EstimatorTier::kTurningPoints, scene.scan_rate_Hz, std::move(prior)) {}

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

Followed follow(const LiveScene& scene, estimate::SharedPrior prior) {
  LiveTrial trial{scene};
  Followed followed{scene, std::move(prior), scene.sigma};
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) followed.add(trial.next());
  followed.end();
  return followed;
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

}  // namespace
}  // namespace stickslip::detect
