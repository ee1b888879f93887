#include "core/sim/scene_truth.hpp"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/friction/slip_waveform.hpp"
#include "core/sim/belt.hpp"
#include "core/sim/first_slip.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/traditional_truth.hpp"

namespace stickslip::sim {
namespace {

using friction::Mode;
using friction::Regime;

/// Writes down what happens, in seconds.
class Chronicle final : public MotionObserver {
 public:
  struct Slip {
    double onset_s = 0.0;
    Coefficients paper;
    double coefficient = 0.0;
    std::optional<double> stick_again_s;
  };

  explicit Chronicle(double scan_rate_Hz) : scan_rate_Hz_(scan_rate_Hz) {}

  void mode_began(const ModeStart& start) override {
    const double now_s = start.time.periods_since({}) / scan_rate_Hz_;
    const bool sticks = start.mode == Mode::kStick || (start.capture && start.onset);
    if (sticks && !slips_.empty() && !slips_.back().stick_again_s) slips_.back().stick_again_s = now_s;
    if (start.onset) slips_.push_back({now_s, start.paper, start.coefficient, {}});
    if (!modes_.empty()) {
      if (modes_.back().mode == start.mode && !start.onset) return;
      close(now_s);
    }
    modes_.push_back({now_s, now_s, start.mode});
  }

  /// Ends the last mode; those that took no time are forgotten.
  void close(double now_s) {
    modes_.back().end_s = now_s;
    if (!(modes_.back().start_s < now_s)) modes_.pop_back();
  }

  [[nodiscard]] std::vector<friction::ModeInterval> take_modes() noexcept { return std::move(modes_); }
  [[nodiscard]] const std::vector<Slip>& slips() const noexcept { return slips_; }

 private:
  double scan_rate_Hz_;
  std::vector<friction::ModeInterval> modes_;
  std::vector<Slip> slips_;
};

/// How the slips of the pull ended.
struct Tally {
  int captured = 0;
  int not_captured = 0;
  std::vector<double> onsets_s;
  Chronicle::Slip first;
};

Tally tally(const std::vector<Chronicle::Slip>& slips, double pull_end_s, double period_s) {
  Tally result;
  double longest_slip_s = 2.0 * period_s;  // A damped slip is captured within its first period.
  for (const Chronicle::Slip& slip : slips) {
    if (slip.onset_s >= pull_end_s) break;
    if (result.onsets_s.empty()) result.first = slip;
    result.onsets_s.push_back(slip.onset_s);
    if (slip.stick_again_s && *slip.stick_again_s < pull_end_s) {
      ++result.captured;
      longest_slip_s = std::max(longest_slip_s, *slip.stick_again_s - slip.onset_s);
    } else if (pull_end_s - slip.onset_s > longest_slip_s) {
      ++result.not_captured;
    }
  }
  return result;
}

Regime regime_of(const Tally& slips, bool oscillates) {
  if (slips.captured > 0 && slips.not_captured > 0) return Regime::kMixed;
  if (slips.captured > 0) return Regime::kStickSlip;
  if (slips.not_captured > 0) return oscillates ? Regime::kRingDown : Regime::kSteadySliding;
  return Regime::kUndecided;
}

void describe_oscillation(const Scene& scene, const Tally& slips, friction::TestTruth& truth) {
  if (slips.onsets_s.empty() || !scene.oscillator.oscillates()) return;
  if (slips.onsets_s.size() > 1) {
    truth.oscillation_frequency_Hz =
        static_cast<double>(slips.onsets_s.size() - 1) / (slips.onsets_s.back() - slips.onsets_s.front());
  } else if (slips.not_captured > 0) {
    truth.oscillation_frequency_Hz = scene.oscillator.omega_rad_per_s() / (2.0 * std::numbers::pi);
  }
  const double r = scene.oscillator.stick_rate_per_s(truth.pull_speed_m_per_s, scene.gravity_m_per_s2);
  const friction::SlipWaveform slip{slips.first.paper.mu_k, slips.first.coefficient - slips.first.paper.mu_k,
                                    r, scene.oscillator};
  double least = slip.value(slip.trough_time_s());
  if (scene.one_way_coupling) least = std::max(least, 0.0);
  truth.amplitude = (slip.value(slip.peak_time_s()) - least) / 2.0;
}

/// A clock that is fast makes a record seem long.
void as_recorded(friction::TestTruth& truth, double recorded_per_true) {
  for (friction::ModeInterval& mode : truth.modes) {
    mode.start_s *= recorded_per_true;
    mode.end_s *= recorded_per_true;
  }
  for (friction::TrueCycle& cycle : truth.cycles) cycle.onset_time_s *= recorded_per_true;
}

}  // namespace

friction::TestTruth scene_truth(const Scene& scene, double nominal_rate_Hz, std::uint64_t seed,
                                const friction::Method& method) {
  const double scan_rate_Hz = true_scan_rate_Hz(scene, nominal_rate_Hz);
  friction::TestTruth truth;
  truth.scene_name = scene.name;
  truth.scene_text = scene.text;
  truth.seed = seed;
  truth.mu_s = scene.mu_s;
  truth.mu_k = scene.mu_k;
  truth.omega_rad_per_s = scene.oscillator.omega_rad_per_s();
  truth.gamma_over_2omega = scene.oscillator.gamma_over_2omega();

  Chronicle chronicle{scan_rate_Hz};
  const Motion scene_motion = motion_of(scene);
  const auto motion = make_motion_solver(scene_motion, scan_rate_Hz, scene.accuracy, &chronicle, seed);
  motion->skip(scan_count(scene, nominal_rate_Hz));
  const SolverMethod solver = motion->method();
  truth.solver = friction::SolverFacts{std::string{solver.name}, solver.accuracy, scene.accuracy, {}};
  chronicle.close(scene.duration_s);
  truth.modes = chronicle.take_modes();
  truth.cycles.reserve(chronicle.slips().size());
  for (const Chronicle::Slip& slip : chronicle.slips()) {
    truth.cycles.push_back({slip.onset_s, slip.paper.mu_s, slip.paper.mu_k});
  }

  if (const std::optional<Pull> pull = pull_of(scene)) {
    const double period_s = 2.0 * std::numbers::pi / scene.oscillator.omega_rad_per_s();
    const Tally slips = tally(chronicle.slips(), pull->end_s, period_s);
    // Where the speed changes, that at which the first slip begins.
    truth.pull_speed_m_per_s = slips.onsets_s.empty()
                                   ? steady_pull_speed_m_per_s(scene).value_or(0.0)
                                   : belt_speed_m_per_s(scene_motion.belt, slips.onsets_s.front());
    truth.regime = regime_of(slips, scene.oscillator.oscillates());
    describe_oscillation(scene, slips, truth);
    if (truth.amplitude && !has_closed_form(motion_of(scene))) {
      truth.amplitude = first_slip_amplitude(scene, seed, slips.onsets_s.front());
    }
    if (!slips.onsets_s.empty() && scene.oscillator.oscillates()) {
      const TraditionalTruth traditional =
          traditional_truth(scene, seed, slips.onsets_s.front(), method, truth.pull_speed_m_per_s);
      truth.static_coefficient = traditional.static_coefficient;
      truth.kinetic_coefficient = traditional.kinetic_coefficient;
    }
  }
  if (scene.clock_rate_error) as_recorded(truth, scan_rate_Hz / nominal_rate_Hz);
  return truth;
}

}  // namespace stickslip::sim
