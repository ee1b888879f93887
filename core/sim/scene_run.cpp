#include "core/sim/scene_run.hpp"

#include <algorithm>
#include <array>

namespace stickslip::sim {

SceneRun::SceneRun(const Scene& scene, double scan_rate_Hz)
    : true_scan_rate_Hz_(true_scan_rate_Hz(scene, scan_rate_Hz)),
      scan_count_(scan_count(scene, scan_rate_Hz)),
      volts_per_coefficient_(scene.normal_load_N() / scene.load_cell.gain_N_per_V),
      zero_V_(scene.load_cell.zero_V),
      motion_(motion_of(scene), true_scan_rate_Hz_) {
  if (scene.damping) other_effects_.push_back("damping");
  if (scene.constant_speed) other_effects_.push_back("constant_speed");
  if (scene.one_way_coupling) other_effects_.push_back("one_way_coupling");
  if (scene.paper.scatter) other_effects_.push_back("scatter");
  if (scene.paper.first_peak) other_effects_.push_back("first_peak");
  if (scene.paper.contact_ageing) other_effects_.push_back("contact_ageing");
  if (scene.onset_convention) other_effects_.push_back("onset_convention");
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
  motion_.restart(seed);
  if (transducer_) transducer_->restart();
  if (jitter_) jitter_->restart(seed);
  for (const auto& effect : signal_) effect->restart(seed);
  if (missing_) missing_->restart(seed);
  lose_missing();
}

std::size_t SceneRun::next(std::span<double> raw) {
  const std::int64_t end = missing_ ? std::min(missing_->first(), scan_count_) : scan_count_;
  const std::span<double> readings =
      raw.first(std::min(raw.size(), static_cast<std::size_t>(end - next_scan_)));
  make(readings);
  lose_missing();
  return readings.size();
}

double SceneRun::coefficient_at(const ScanTime& instant) {
  if (!transducer_) return motion_.at(instant);
  motion_.follow_to(instant, *transducer_);
  return transducer_->output();
}

void SceneRun::make(std::span<double> readings) {
  if (jitter_ || transducer_) {
    std::int64_t scan = next_scan_;
    for (double& reading : readings) {
      reading = coefficient_at(jitter_ ? jitter_->instant(scan) : ScanTime{scan, 0.0});
      ++scan;
    }
  } else {
    motion_.next(readings);
  }
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
      make(std::span{lost}.first(std::min(lost.size(), static_cast<std::size_t>(end - next_scan_))));
    missing_->next();
  }
}

std::vector<std::string_view> SceneRun::effects() const {
  std::vector<std::string_view> names = other_effects_;
  for (const auto& effect : signal_) names.push_back(effect->name());
  return names;
}

}  // namespace stickslip::sim
