/// \file
/// A simulated pull at 12 in/min without anything but what a test asks for.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace stickslip::test {

struct PlainPull {
  static constexpr double kRate_Hz = 350.0;
  static constexpr double kIdle_s = 0.5;
  static constexpr double kNoise = 0.001;

  double K = 0.30;
  double delta_mu = 0.05;
  double pull_s = 3.0;
  std::string effects;  ///< Beside damping (γ/2ω 0.022, 20 Hz) and noise, as in a scene.
  std::uint64_t seed = 3;

  /// Coefficients of the scans up to the end of the pull.
  [[nodiscard]] std::vector<double> coefficients() const {
    // A newton a volt over m g: a volt is the coefficient.
    const std::string text = fmt::format(
        "description = \"a plain pull\"\nscan_rate = \"{} Hz\"\n[tester]\nsled_mass = \"2.331 kg\"\n"
        "gravity = \"9.80665 m/s^2\"\nfrequency = \"20 Hz\"\nload_cell_gain = \"22.85930115 N/V\"\n"
        "[paper]\nmu_s = {}\nmu_k = {}\n[effects.damping]\ngamma_over_2omega = 0.022\n"
        "[effects.constant_speed]\nidle = \"{} s\"\npull_speed = \"12 in/min\"\npull = \"{} s\"\n"
        "stop = \"0 s\"\nreturn_speed = \"12 in/min\"\nreturn = \"0.01 s\"\nrest = \"0 s\"\n"
        "[effects.white_noise]\nsd = {}\n{}",
        kRate_Hz, K + delta_mu, K, kIdle_s, pull_s, kNoise, effects);
    const auto scene = sim::parse_scene(text, "plain_pull.hpp");
    if (!scene) throw std::runtime_error(scene.error().message);
    sim::SceneRun run{*scene, scene->scan_rate_Hz};
    run.restart(seed);
    std::vector<double> values;
    std::array<double, 64> raw{};
    while (const std::size_t count = run.next(raw))
      values.insert(values.end(), raw.begin(), raw.begin() + count);
    values.resize(static_cast<std::size_t>((kIdle_s + pull_s) * kRate_Hz));
    return values;
  }
};

}  // namespace stickslip::test
