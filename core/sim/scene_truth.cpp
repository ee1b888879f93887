#include "core/sim/scene_truth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/long_column.hpp"
#include "core/model/slip_waveform.hpp"
#include "core/sim/belt.hpp"
#include "core/sim/first_slip.hpp"
#include "core/sim/motion_solver.hpp"
#include "core/sim/traditional_truth.hpp"

namespace stickslip::sim {
namespace {

using model::Mode;
using model::Regime;

/// Writes down what happens before the end of the scene, in seconds.
class Chronicle final : public MotionObserver {
 public:
  struct Slip {
    double onset_s = 0.0;
    Coefficients paper;
    double coefficient = 0.0;
    std::optional<double> stick_again_s;
  };

  /// The belt started faster than friction can pull the sled along: it slides without having given way.
  struct Slide {
    double start_s = 0.0;
    double end_s = 0.0;
  };

  Chronicle(double scan_rate_Hz, double end_s, const std::filesystem::path& scratch_folder)
      : scan_rate_Hz_(scan_rate_Hz),
        end_s_(end_s),
        modes_(scratch_folder),
        slips_(scratch_folder),
        slides_(scratch_folder) {}

  void mode_began(const ModeStart& start) override {
    const double now_s = start.time.periods_since({}) / scan_rate_Hz_;
    if (now_s >= end_s_) return;  // A numeric solver goes beyond the last scan.
    const bool sticks = start.mode == Mode::kStick || (start.capture && start.onset);
    if (sticks && slip_ && !slip_->stick_again_s) slip_->stick_again_s = now_s;
    const bool rests = !mode_ || mode_->mode == Mode::kStick;
    if (start.mode != Mode::kSlip) end_slide(now_s);
    if (rests && start.mode == Mode::kSlip && !start.onset) slide_start_s_ = now_s;
    if (start.onset) {
      if (slip_) slips_.push_back(*slip_);
      slip_ = Slip{now_s, start.paper, start.coefficient, {}};
    }
    if (mode_ && mode_->mode == start.mode && !start.onset) return;
    end_mode(now_s);
    mode_ = model::ModeInterval{now_s, now_s, start.mode};
  }

  /// Nothing comes any more.
  void close() {
    end_mode(end_s_);
    end_slide(end_s_);
    if (slip_) slips_.push_back(*slip_);
    slip_.reset();
  }

  [[nodiscard]] base::LongColumn<model::ModeInterval> take_modes() { return std::exchange(modes_, {}); }
  [[nodiscard]] const base::LongColumn<Slip>& slips() const noexcept { return slips_; }
  [[nodiscard]] const base::LongColumn<Slide>& slides() const noexcept { return slides_; }

 private:
  /// Modes that took no time are forgotten.
  void end_mode(double now_s) {
    if (mode_ && mode_->start_s < now_s) modes_.push_back({mode_->start_s, now_s, mode_->mode});
    mode_.reset();
  }

  void end_slide(double now_s) {
    if (slide_start_s_) slides_.push_back({*slide_start_s_, now_s});
    slide_start_s_.reset();
  }

  double scan_rate_Hz_;
  double end_s_;
  std::optional<model::ModeInterval> mode_;  ///< The present one.
  std::optional<Slip> slip_;                 ///< The latest, which may still stick again.
  std::optional<double> slide_start_s_;
  base::LongColumn<model::ModeInterval> modes_;
  base::LongColumn<Slip> slips_;
  base::LongColumn<Slide> slides_;
};

/// How the slips of the pull ended.
struct Tally {
  int captured = 0;
  int not_captured = 0;
  int count = 0;  ///< Slips that began.
  double last_onset_s = 0.0;
  Chronicle::Slip first;
};

Tally tally(const Chronicle& chronicle, double pull_end_s, double period_s) {
  Tally result;
  double longest_slip_s = 2.0 * period_s;  // A damped slip is captured within its first period.
  for (const Chronicle::Slip& slip : chronicle.slips()) {
    if (slip.onset_s >= pull_end_s) break;
    if (result.count == 0) result.first = slip;
    ++result.count;
    result.last_onset_s = slip.onset_s;
    if (slip.stick_again_s && *slip.stick_again_s < pull_end_s) {
      ++result.captured;
      longest_slip_s = std::max(longest_slip_s, *slip.stick_again_s - slip.onset_s);
    } else if (pull_end_s - slip.onset_s > longest_slip_s) {
      ++result.not_captured;
    }
  }
  for (const Chronicle::Slide& slide : chronicle.slides()) {
    if (std::min(slide.end_s, pull_end_s) - slide.start_s > longest_slip_s) ++result.not_captured;
  }
  return result;
}

Regime regime_of(const Tally& slips, bool oscillates) {
  if (slips.captured > 0 && slips.not_captured > 0) return Regime::kMixed;
  if (slips.captured > 0) return Regime::kStickSlip;
  if (slips.not_captured > 0) return oscillates ? Regime::kRingDown : Regime::kSteadySliding;
  return Regime::kUndecided;
}

/// Whether the belt stands still at any time in [begin_s, end_s].
bool stands_between(const std::vector<BeltSegment>& belt, double begin_s, double end_s) {
  double start_s = 0.0;
  for (const BeltSegment& segment : belt) {
    const double stop_s = start_s + segment.duration_s;
    const bool rests = segment.speed_m_per_s == 0.0 && segment.acceleration_m_per_s2 == 0.0 &&
                       segment.jerk_m_per_s3 == 0.0 && segment.decaying_speed_m_per_s == 0.0;
    if (rests && start_s < end_s && begin_s < stop_s) return true;
    start_s = stop_s;
  }
  return false;
}

/// What sliding at that speed adds to K.
double change_by_speed(const VelocityDependence& law, const Coefficients& paper, double speed_m_per_s) {
  const double rise = std::min(law.stribeck_rise, paper.mu_s - paper.mu_k);
  return law.per_speed_s_per_m * speed_m_per_s +
         rise * std::exp(-std::pow(speed_m_per_s / law.stribeck_speed_m_per_s, law.stribeck_exponent));
}

/// S and K as the results mean them: averaged over the slips of the pull, where there are more without the
/// first and those after a hold, which follow another rest; K where the sled slides at the belt's speed.
/// Where contacts scatter and nothing else moves S and K, those of the paper: the results' errors are about
/// them.
void describe_paper(const Motion& motion, const Chronicle& chronicle, double pull_end_s,
                    model::TestTruth& truth) {
  const bool paper_alone = motion.paper.scatter && !motion.paper.contact_ageing && !motion.kinetic_drift;
  const auto in_force = [&](const Coefficients& paper, double speed_m_per_s) {
    Coefficients all = paper_alone ? Coefficients{motion.mu_s, motion.mu_k} : paper;
    if (motion.velocity_dependence)
      all.mu_k += change_by_speed(*motion.velocity_dependence, all, std::abs(speed_m_per_s));
    return all;
  };
  Coefficients mean = in_force({motion.mu_s, motion.mu_k}, truth.pull_speed_m_per_s);
  double count = 0.0;
  double before_s = 0.0;
  for (const Chronicle::Slip& slip : chronicle.slips()) {
    if (slip.onset_s >= pull_end_s) break;
    const bool follows_a_rest = stands_between(motion.belt, before_s, slip.onset_s);
    before_s = slip.onset_s;
    if (follows_a_rest && count > 0.0) continue;
    const Coefficients paper = in_force(slip.paper, belt_speed_m_per_s(motion.belt, slip.onset_s));
    const double share = 1.0 / std::max(1.0, count);  // The second replaces the first.
    count += 1.0;
    mean.mu_s += share * (paper.mu_s - mean.mu_s);
    mean.mu_k += share * (paper.mu_k - mean.mu_k);
  }
  truth.mu_s = mean.mu_s;
  truth.mu_k = mean.mu_k;
}

void describe_oscillation(const Scene& scene, const Tally& slips, model::TestTruth& truth) {
  if (slips.count == 0 || !scene.oscillator.oscillates()) return;
  if (slips.count > 1) {
    truth.oscillation_frequency_Hz =
        static_cast<double>(slips.count - 1) / (slips.last_onset_s - slips.first.onset_s);
  } else if (slips.not_captured > 0) {
    truth.oscillation_frequency_Hz = scene.oscillator.omega_rad_per_s() / (2.0 * std::numbers::pi);
  }
  const double r = scene.oscillator.stick_rate_per_s(truth.pull_speed_m_per_s, scene.gravity_m_per_s2);
  const model::SlipWaveform slip{slips.first.paper.mu_k, slips.first.coefficient - slips.first.paper.mu_k, r,
                                 scene.oscillator};
  double least = slip.value(slip.trough_time_s());
  if (scene.one_way_coupling) least = std::max(least, 0.0);
  truth.amplitude = (slip.value(slip.peak_time_s()) - least) / 2.0;
}

/// A clock that is fast makes a record seem long.
void as_recorded(model::TestTruth& truth, double recorded_per_true,
                 const std::filesystem::path& scratch_folder) {
  base::LongColumn<model::ModeInterval> modes{scratch_folder};
  for (model::ModeInterval mode : std::as_const(truth.modes)) {
    mode.start_s *= recorded_per_true;
    mode.end_s *= recorded_per_true;
    modes.push_back(mode);
  }
  truth.modes = std::move(modes);
  base::LongColumn<model::TrueCycle> cycles{scratch_folder};
  for (model::TrueCycle cycle : std::as_const(truth.cycles)) {
    cycle.onset_time_s *= recorded_per_true;
    cycles.push_back(cycle);
  }
  truth.cycles = std::move(cycles);
}

}  // namespace

model::TestTruth scene_truth(const Scene& scene, double nominal_rate_Hz, std::uint64_t seed,
                             const model::Method& method, const std::filesystem::path& scratch_folder) {
  const double scan_rate_Hz = true_scan_rate_Hz(scene, nominal_rate_Hz);
  model::TestTruth truth;
  truth.scene_name = scene.name;
  truth.scene_text = scene.text;
  truth.seed = seed;
  truth.mu_s = scene.mu_s;
  truth.mu_k = scene.mu_k;
  truth.omega_rad_per_s = scene.oscillator.omega_rad_per_s();
  truth.gamma_over_2omega = scene.oscillator.gamma_over_2omega();

  Chronicle chronicle{scan_rate_Hz, scene.duration_s, scratch_folder};
  const Motion scene_motion = motion_of(scene);
  const auto motion = make_motion_solver(scene_motion, scan_rate_Hz, scene.accuracy, &chronicle, seed);
  motion->skip(scan_count(scene, nominal_rate_Hz));
  const SolverMethod solver = motion->method();
  truth.solver = model::SolverFacts{std::string{solver.name}, solver.accuracy, scene.accuracy, {}};
  chronicle.close();
  truth.modes = chronicle.take_modes();
  truth.cycles = base::LongColumn<model::TrueCycle>{scratch_folder};
  for (const Chronicle::Slip& slip : chronicle.slips()) {
    truth.cycles.push_back({slip.onset_s, slip.paper.mu_s, slip.paper.mu_k});
  }

  if (const std::optional<Pull> pull = pull_of(scene)) {
    const double period_s = 2.0 * std::numbers::pi / scene.oscillator.omega_rad_per_s();
    const Tally slips = tally(chronicle, pull->end_s, period_s);
    // Where the speed changes, that at which the first slip begins.
    truth.pull_speed_m_per_s = slips.count == 0 ? steady_pull_speed_m_per_s(scene).value_or(0.0)
                                                : belt_speed_m_per_s(scene_motion.belt, slips.first.onset_s);
    describe_paper(scene_motion, chronicle, pull->end_s, truth);
    truth.regime = regime_of(slips, scene.oscillator.oscillates());
    describe_oscillation(scene, slips, truth);
    if (truth.amplitude && !has_closed_form(motion_of(scene))) {
      truth.amplitude = first_slip_amplitude(scene, seed, slips.first.onset_s);
    }
    if (slips.count > 0 && scene.oscillator.oscillates()) {
      const TraditionalTruth traditional =
          traditional_truth(scene, seed, slips.first.onset_s, method, truth.pull_speed_m_per_s);
      truth.static_coefficient = traditional.static_coefficient;
      truth.kinetic_coefficient = traditional.kinetic_coefficient;
    }
  }
  if (scene.clock_rate_error) as_recorded(truth, scan_rate_Hz / nominal_rate_Hz, scratch_folder);
  return truth;
}

}  // namespace stickslip::sim
