#include "core/sim/scene_run.hpp"

#include <algorithm>

namespace stickslip::sim {

SceneRun::SceneRun(const Scene& scene, double scan_rate_Hz)
    : scan_count_(scan_count(scene, scan_rate_Hz)),
      volts_per_coefficient_(scene.normal_load_N() / scene.load_cell.gain_N_per_V),
      zero_V_(scene.load_cell.zero_V),
      motion_(motion_of(scene), scan_rate_Hz) {
  if (scene.damping) motion_effects_.push_back("damping");
  if (scene.constant_speed) motion_effects_.push_back("constant_speed");
  if (scene.one_way_coupling) motion_effects_.push_back("one_way_coupling");
  if (scene.paper.scatter) motion_effects_.push_back("scatter");
  if (scene.paper.first_peak) motion_effects_.push_back("first_peak");
  if (scene.paper.contact_ageing) motion_effects_.push_back("contact_ageing");
  if (scene.onset_convention) motion_effects_.push_back("onset_convention");
  if (scene.white_noise) signal_.push_back(make_white_noise(*scene.white_noise));
  if (scene.quantisation) signal_.push_back(make_quantisation(*scene.quantisation));
  restart(scene.seed);
}

void SceneRun::restart(std::uint64_t seed) {
  next_scan_ = 0;
  motion_.restart(seed);
  for (const auto& effect : signal_) effect->restart(seed);
}

std::size_t SceneRun::next(std::span<double> raw) {
  const auto left = static_cast<std::size_t>(scan_count_ - next_scan_);
  const std::span<double> readings = raw.first(std::min(raw.size(), left));
  motion_.next(readings);
  for (double& reading : readings) reading = zero_V_ + reading * volts_per_coefficient_;
  for (const auto& effect : signal_) effect->apply(readings);
  next_scan_ += static_cast<std::int64_t>(readings.size());
  return readings.size();
}

std::vector<std::string_view> SceneRun::effects() const {
  std::vector<std::string_view> names = motion_effects_;
  for (const auto& effect : signal_) names.push_back(effect->name());
  return names;
}

}  // namespace stickslip::sim
