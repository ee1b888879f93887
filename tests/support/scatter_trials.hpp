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

#include "core/analysis/pooled_slips.hpp"
#include "core/analysis/test_analysis.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"
#include "core/sim/scene_truth.hpp"

namespace stickslip::test {

struct ScatterTrials {
  static constexpr double kDeltaMu = 0.05;
  static constexpr double kCv = 0.30;  ///< Standard deviation over mean of S − K, log-normal.
  static constexpr double kPull_s = 2.0;

  std::vector<std::vector<detect::Cycle>> cycles;  ///< Of each test.
  std::vector<analysis::Estimate> delta_mu;        ///< Of each test.
  std::vector<analysis::TestResults> results;      ///< Of each test.
  /// S − K found less the true one, of each slip after the first that was seen not to stick again.
  std::vector<double> escape_errors;

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

  /// \param seeds  first_seed and those after it, one test each.
  ScatterTrials(double speed_in_per_min, int seeds, int first_seed = 1) {
    const sim::Scene scene = scene_at(speed_in_per_min);
    sim::SceneRun run{scene, scene.scan_rate_Hz};
    const auto pull_end = static_cast<base::ScanIndex>((0.5 + kPull_s) * scene.scan_rate_Hz);
    for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
      run.restart(static_cast<std::uint64_t>(seed));
      analysis::TestAnalysis analysis{analysis::AnalysisSettings{}};
      base::ScanIndex index = 0;
      std::array<double, 64> raw{};
      while (const std::size_t count = run.next(raw)) {
        for (std::size_t k = 0; k < count; ++k, ++index) {
          if (index < pull_end) analysis.add(index, raw[k], false);
        }
      }
      results.push_back(analysis.finish());
      cycles.emplace_back(analysis.cycles().begin(), analysis.cycles().end());
      // Of the fit, not of what stands in for it.
      const analysis::TestResults& found = results.back();
      delta_mu.push_back(found.omega.value ? found.delta_mu : analysis::Estimate::none(found.omega.reason));
      keep_escapes(sim::scene_truth(scene, scene.scan_rate_Hz, static_cast<std::uint64_t>(seed)));
    }
  }

  /// How well the S − K of a slip that escapes is known.
  struct Escapes {
    std::size_t count = 0;
    double rms = 0.0;
    double bias = 0.0;
    double bias_error = 0.0;  ///< Standard error.
  };
  [[nodiscard]] Escapes escapes() const {
    Escapes found{.count = escape_errors.size()};
    const auto n = static_cast<double>(found.count);
    double squares = 0.0;
    for (const double error : escape_errors) {
      found.bias += error / n;
      squares += error * error / n;
    }
    found.rms = std::sqrt(squares);
    found.bias_error = std::sqrt(std::max(squares - found.bias * found.bias, 0.0) / n);
    return found;
  }

  /// Of the tests that have an S − K: what one would get without pooling by cycle.
  [[nodiscard]] analysis::Estimate mean_of_means() const {
    double n = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    for (const analysis::Estimate& found : delta_mu) {
      if (!found.value) continue;
      n += 1.0;
      sum += *found.value;
      squares += *found.value * *found.value;
    }
    const double mean = sum / n;
    return analysis::Estimate::of(mean, std::sqrt((squares / n - mean * mean) / (n - 1.0)));
  }

  /// Rms over the tests of (estimate − 0.05) in terms of 0.05 · CV/√M, where M are the slips that count.
  [[nodiscard]] double rms_over_sampling() const {
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
      if (!delta_mu[i].value) continue;
      double slips = -1.0;  // The first does not count, if there are three.
      for (const detect::Cycle& cycle : cycles[i]) slips += std::isfinite(cycle.delta_mu) ? 1.0 : 0.0;
      if (slips < 2.0) continue;
      squares += std::pow((*delta_mu[i].value - kDeltaMu) / (kDeltaMu * kCv), 2) * slips;
      count += 1.0;
    }
    return std::sqrt(squares / count);
  }

  /// An rms of n values scatters by 1/√(2n) of itself.
  [[nodiscard]] double rms_error_of_it() const {
    const auto n = static_cast<double>(cycles.size()) - without_delta_mu();
    return rms_over_sampling() / std::sqrt(2.0 * n);
  }

  [[nodiscard]] int without_delta_mu() const {
    return static_cast<int>(std::count_if(delta_mu.begin(), delta_mu.end(),
                                          [](const analysis::Estimate& found) { return !found.value; }));
  }

 private:
  /// Of the latest test.
  void keep_escapes(const model::TestTruth& truth) {
    constexpr double kSameSlip_s = 0.01;  // A fifth of an oscillation.
    const std::vector<detect::Cycle>& found = cycles.back();
    for (std::size_t i = 0; i + 1 < found.size(); ++i) {
      const detect::Cycle& slip = found[i];
      const unsigned kNoEscape = detect::kCycleCaptured | detect::kCycleIsFirst;
      if ((slip.flags & kNoEscape) != 0 || !std::isfinite(slip.delta_mu)) continue;
      for (const model::TrueCycle& real : truth.cycles) {
        if (std::abs(real.onset_time_s - slip.onset_time_s) < kSameSlip_s)
          escape_errors.push_back(slip.delta_mu - (real.mu_s - real.mu_k));
      }
    }
  }
};

}  // namespace stickslip::test
