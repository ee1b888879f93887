#include "drivers/simulated/scene_facts.hpp"

#include <algorithm>
#include <optional>

namespace stickslip::drivers {

daq::BoardInfo board_info_of(const std::vector<sim::Scene>& scenes, double scan_rate_Hz,
                             std::optional<double> speed_gain_m_per_s_per_V) {
  daq::BoardInfo info;
  info.driver = "simulated";
  info.board_name = "simulated tester";
  for (const sim::Scene& scene : scenes) {
    info.device += (info.device.empty() ? "" : ", ") + scene.name;
  }
  info.scan_rate_requested_Hz = scan_rate_Hz;
  info.scan_rate_granted_Hz = scan_rate_Hz;
  info.quantity = daq::RawQuantity::kVolts;
  if (const auto& converter = scenes.front().quantisation) {
    info.quantity = daq::RawQuantity::kCounts;
    info.maxdata = converter->maxdata();
    info.range_min_V = converter->range_min_V;
    info.range_max_V = converter->range_max_V;
    info.polynomial = {converter->range_min_V,
                       (converter->range_max_V - converter->range_min_V) / converter->maxdata()};
  }
  if (speed_gain_m_per_s_per_V) {
    daq::SecondChannel& speed = info.second.emplace();
    speed.maxdata = info.maxdata;
    speed.range_min_V = info.range_min_V;
    speed.range_max_V = info.range_max_V;
    speed.polynomial = info.polynomial;
    speed.gain_per_V = *speed_gain_m_per_s_per_V;
  }
  return info;
}

daq::LoadCell load_cell_of(const sim::Scene& scene) {
  return {scene.load_cell.gain_N_per_V, scene.load_cell.zero_V};
}

model::Tester tester_of(const std::vector<sim::Scene>& scenes) {
  model::Tester tester;
  tester.sled_mass_kg = scenes.front().sled_mass_kg;
  tester.gravity_m_per_s2 = scenes.front().gravity_m_per_s2;
  const auto speed = [](const sim::Scene& scene) { return sim::steady_pull_speed_m_per_s(scene); };
  const auto same = [&](const sim::Scene& scene) { return speed(scene) == speed(scenes.front()); };
  if (std::all_of(scenes.begin(), scenes.end(), same)) tester.pull_speed_m_per_s = speed(scenes.front());
  const auto course = sim::pull_speed_of(scenes.front());
  const auto same_course = [&](const sim::Scene& scene) { return sim::pull_speed_of(scene) == course; };
  if (std::all_of(scenes.begin(), scenes.end(), same_course)) tester.speed_course = course;
  return tester;
}

}  // namespace stickslip::drivers
