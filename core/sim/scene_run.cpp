#include "core/sim/scene_run.hpp"

#include <algorithm>
#include <array>

#include "core/base/contract.hpp"

namespace stickslip::sim {

SceneRun::SceneRun(const Scene& scene, double scan_rate_Hz)
    : true_scan_rate_Hz_(true_scan_rate_Hz(scene, scan_rate_Hz)),
      scan_count_(scan_count(scene, scan_rate_Hz)),
      volts_per_coefficient_(scene.normal_load_N() / scene.load_cell.gain_N_per_V),
      zero_V_(scene.load_cell.zero_V),
      motion_(make_motion_solver(motion_of(scene), true_scan_rate_Hz_, scene.accuracy)) {
  if (scene.damping) other_effects_.push_back("damping");
  if (scene.constant_speed) other_effects_.push_back("constant_speed");
  if (scene.speed_ramp) other_effects_.push_back("speed_ramp");
  if (scene.exponential_start) other_effects_.push_back("exponential_start");
  if (scene.jerk_limited_start) other_effects_.push_back("jerk_limited_start");
  if (scene.piecewise_speed) other_effects_.push_back("piecewise_speed");
  if (scene.one_way_coupling) other_effects_.push_back("one_way_coupling");
  if (scene.startup_slack_m) other_effects_.push_back("startup_slack");
  if (scene.kinetic_drift) other_effects_.push_back("kinetic_drift");
  if (scene.paper.scatter) other_effects_.push_back("scatter");
  if (scene.paper.first_peak) other_effects_.push_back("first_peak");
  if (scene.paper.contact_ageing) other_effects_.push_back("contact_ageing");
  if (scene.onset_convention) other_effects_.push_back("onset_convention");
  if (scene.velocity_dependence_s_per_m) other_effects_.push_back("velocity_dependence");
  if (scene.stribeck) other_effects_.push_back("stribeck");
  if (scene.rate_and_state) other_effects_.push_back("rate_and_state");
  if (scene.load_cell_dynamics || scene.anti_alias) {
    transducer_.emplace(scene.load_cell_dynamics, scene.anti_alias, scene.oscillator, true_scan_rate_Hz_);
    if (scene.load_cell_dynamics) other_effects_.push_back("load_cell");
    if (scene.anti_alias) other_effects_.push_back("anti_alias");
  }
  if (scene.clock_rate_error) other_effects_.push_back("clock_rate_error");
  if (scene.clock_jitter) {
    jitter_.emplace(*scene.clock_jitter, true_scan_rate_Hz_);
    other_effects_.push_back(JitteringClock::kName);
  }
  if (scene.missing_scans) {
    missing_.emplace(*scene.missing_scans, true_scan_rate_Hz_);
    other_effects_.push_back(MissingBursts::kName);
  }
  if (scene.white_noise) signal_.push_back(make_white_noise(*scene.white_noise));
  if (scene.drift_noise) signal_.push_back(make_drift_noise(*scene.drift_noise, true_scan_rate_Hz_));
  if (scene.mains_hum) signal_.push_back(make_mains_hum(*scene.mains_hum, true_scan_rate_Hz_));
  if (scene.spikes) signal_.push_back(make_spikes(*scene.spikes, true_scan_rate_Hz_));
  if (scene.quantisation) signal_.push_back(make_quantisation(*scene.quantisation));
  restart(scene.seed);
}

void SceneRun::restart(std::uint64_t seed) {
  next_scan_ = 0;
  motion_->restart(seed);
  if (transducer_) transducer_->restart();
  if (jitter_) jitter_->restart(seed);
  for (const auto& effect : signal_) effect->restart(seed);
  if (missing_) missing_->restart(seed);
  lose_missing();
}

std::size_t SceneRun::next(std::span<double> raw, std::span<double> coefficient) {
  STICKSLIP_EXPECTS(coefficient.empty() || coefficient.size() == raw.size());
  const std::int64_t end = missing_ ? std::min(missing_->first(), scan_count_) : scan_count_;
  const std::span<double> readings =
      raw.first(std::min(raw.size(), static_cast<std::size_t>(end - next_scan_)));
  make(readings, coefficient.empty() ? coefficient : coefficient.first(readings.size()));
  lose_missing();
  return readings.size();
}

void SceneRun::look(std::span<double> readings, std::span<double> coefficient) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const std::int64_t scan = next_scan_ + static_cast<std::int64_t>(i);
    const ScanTime instant = jitter_ ? jitter_->instant(scan) : ScanTime{scan, 0.0};
    if (!transducer_) {
      readings[i] = motion_->at(instant);
    } else {
      motion_->follow_to(instant, *transducer_);
      readings[i] = transducer_->output();
      if (!coefficient.empty()) coefficient[i] = motion_->at(instant);
    }
  }
}

void SceneRun::make(std::span<double> readings, std::span<double> coefficient) {
  if (jitter_ || transducer_) {
    look(readings, coefficient);
  } else {
    motion_->next(readings);
  }
  // Without a transducer what the converter sees is the force itself.
  if (!transducer_ && !coefficient.empty()) std::copy(readings.begin(), readings.end(), coefficient.begin());
  for (double& reading : readings) reading = zero_V_ + reading * volts_per_coefficient_;
  for (const auto& effect : signal_) effect->apply(readings);
  next_scan_ += static_cast<std::int64_t>(readings.size());
}

void SceneRun::lose_missing() {
  if (!missing_) return;
  std::array<double, 64> lost{};  // A piece of the burst at a time.
  while (next_scan_ < scan_count_ && next_scan_ == missing_->first()) {
    const std::int64_t end = std::min(missing_->end(), scan_count_);
    while (next_scan_ < end)
      make(std::span{lost}.first(std::min(lost.size(), static_cast<std::size_t>(end - next_scan_))), {});
    missing_->next();
  }
}

std::vector<std::string_view> SceneRun::effects() const {
  std::vector<std::string_view> names = other_effects_;
  for (const auto& effect : signal_) names.push_back(effect->name());
  return names;
}

}  // namespace stickslip::sim
