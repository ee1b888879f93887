/// \file
/// Pulls over paper whose S − K differs from slip to slip, through the simulator and the whole analysis.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/friction/replicates.hpp"
#include "core/friction/test_analysis.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace stickslip::test {

struct ScatterTrials {
  static constexpr double kDeltaMu = 0.05;
  static constexpr double kCv = 0.30;  ///< Standard deviation over mean of S − K, log-normal.
  static constexpr double kPull_s = 2.0;

  std::vector<std::vector<friction::Cycle>> cycles;  ///< Of each test.
  std::vector<friction::Estimate> delta_mu;          ///< Of each test.
  std::vector<friction::TestResults> results;        ///< Of each test.

  static sim::Scene scene_at(double speed_in_per_min) {
    // A newton a volt over m g: a volt is the coefficient.
    const std::string text = fmt::format(
        "description = \"30 % scatter\"\nscan_rate = \"350 Hz\"\n[tester]\nsled_mass = \"2.331 kg\"\n"
        "gravity = \"9.80665 m/s^2\"\nfrequency = \"20 Hz\"\nload_cell_gain = \"22.85930115 N/V\"\n"
        "[paper]\nmu_s = 0.35\nmu_k = 0.30\n[effects.damping]\ngamma_over_2omega = 0.022\n"
        "[effects.constant_speed]\nidle = \"0.5 s\"\npull_speed = \"{} in/min\"\npull = \"{} s\"\n"
        "stop = \"0 s\"\nreturn_speed = \"12 in/min\"\nreturn = \"0.01 s\"\nrest = \"0 s\"\n"
        "[effects.scatter]\ndelta_mu_cv = {}\n[effects.white_noise]\nsd = 0.001\n",
        speed_in_per_min, kPull_s, kCv);
    const auto scene = sim::parse_scene(text, "scatter_trials.hpp");
    if (!scene) throw std::runtime_error(scene.error().message);
    return *scene;
  }

  /// \param seeds  1 to seeds, one test each.
  ScatterTrials(double speed_in_per_min, int seeds) {
    const sim::Scene scene = scene_at(speed_in_per_min);
    sim::SceneRun run{scene, scene.scan_rate_Hz};
    const auto pull_end = static_cast<base::ScanIndex>((0.5 + kPull_s) * scene.scan_rate_Hz);
    for (int seed = 1; seed <= seeds; ++seed) {
      run.restart(static_cast<std::uint64_t>(seed));
      friction::TestAnalysis analysis{friction::AnalysisSettings{}};
      base::ScanIndex index = 0;
      std::array<double, 64> raw{};
      while (const std::size_t count = run.next(raw)) {
        for (std::size_t k = 0; k < count; ++k, ++index) {
          if (index < pull_end) analysis.add(index, raw[k], false);
        }
      }
      results.push_back(analysis.finish());
      cycles.emplace_back(analysis.cycles().begin(), analysis.cycles().end());
      delta_mu.push_back(results.back().delta_mu);
    }
  }

  /// Rms over the tests of (estimate − 0.05) in terms of 0.05 · CV/√M, where M are the slips that count.
  [[nodiscard]] double rms_over_sampling() const {
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
      if (!delta_mu[i].value) continue;
      double slips = -1.0;  // The first does not count, if there are three.
      for (const friction::Cycle& cycle : cycles[i]) slips += std::isfinite(cycle.delta_mu) ? 1.0 : 0.0;
      if (slips < 2.0) continue;
      squares += std::pow((*delta_mu[i].value - kDeltaMu) / (kDeltaMu * kCv), 2) * slips;
      count += 1.0;
    }
    return std::sqrt(squares / count);
  }

  [[nodiscard]] int without_delta_mu() const {
    return static_cast<int>(std::count_if(delta_mu.begin(), delta_mu.end(),
                                          [](const friction::Estimate& found) { return !found.value; }));
  }
};

}  // namespace stickslip::test
