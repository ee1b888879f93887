/// \file
/// Ramps from 0.3 to 1.5 times the threshold speed over paper whose S − K scatters, through the simulator and
/// the whole analysis: what they say of S − K and of the threshold speed, against the simulator's truth.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>

#include "core/analysis/test_analysis.hpp"
#include "core/model/threshold.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_run.hpp"

namespace stickslip::test {

/// Running mean and variance [Welford, Technometrics 4(3):419–420, 1962].
struct Spread {
  double count = 0.0;
  double mean = 0.0;
  double squares = 0.0;

  void add(double value) noexcept {
    count += 1.0;
    const double off = value - mean;
    mean += off / count;
    squares += off * (value - mean);
  }
  [[nodiscard]] double sd() const noexcept { return std::sqrt(squares / (count - 1.0)); }
  [[nodiscard]] double standard_error() const noexcept { return sd() / std::sqrt(count); }
};

struct RampTrials {
  static constexpr double kS = 0.35;
  static constexpr double kK = 0.30;
  static constexpr double kDeltaMu = kS - kK;
  static constexpr double kGammaOver2Omega = 0.022;
  static constexpr double kFrom = 0.3;  ///< Of the threshold speed,
  static constexpr double kTo = 1.5;

  double acceleration_m_per_s2 = 0.0;
  double cv = 0.0;  ///< Standard deviation over mean of S − K, log-normal.

  int tests = 0;
  int without_delta_mu = 0;
  int without_escape = 0;
  Spread slips;         ///< Slips of a test that began from sticking, the escaping one included.
  Spread delta_mu;      ///< A test's S − K over the true mean.
  Spread delta_mu_z;    ///< Error over standard error.
  double pooled = 0.0;  ///< S − K of all slips of all tests but the first of each, over the true mean.
  double pooled_count = 0.0;
  double error_squares = 0.0;  ///< Of S − K of a test in terms of CV/√N.
  Spread escape;               ///< Over the threshold speed.
  Spread corrected;            ///< Over the threshold speed.
  Spread corrected_z;          ///< Error over standard error.

  [[nodiscard]] static double threshold_m_per_s() {
    return model::threshold_speed_m_per_s(
        model::Oscillator::from_omega(2.0 * std::numbers::pi * 20.0, kGammaOver2Omega), kDeltaMu,
        model::kStandardGravity_m_per_s2);
  }

  [[nodiscard]] sim::Scene scene() const {
    const double v_th = threshold_m_per_s();
    // A newton a volt over m g: a volt is the coefficient.
    const std::string text = fmt::format(
        "description = \"ramp\"\nscan_rate = \"350 Hz\"\n[tester]\nsled_mass = \"2.331 kg\"\n"
        "gravity = \"9.80665 m/s^2\"\nfrequency = \"20 Hz\"\nload_cell_gain = \"22.85930115 N/V\"\n"
        "[paper]\nmu_s = {}\nmu_k = {}\n[effects.damping]\ngamma_over_2omega = {}\n"
        "[effects.constant_speed]\nidle = \"0.5 s\"\npull_speed = \"{} m/s\"\npull = \"{} s\"\n"
        "stop = \"0.2 s\"\nreturn_speed = \"12 in/min\"\nreturn = \"0.01 s\"\nrest = \"0 s\"\n"
        "[effects.speed_ramp]\nto = \"{} m/s\"\n{}[effects.white_noise]\nsd = 0.001\n",
        kS, kK, kGammaOver2Omega, kFrom * v_th, (kTo - kFrom) * v_th / acceleration_m_per_s2, kTo * v_th,
        cv > 0.0 ? fmt::format("[effects.scatter]\ndelta_mu_cv = {}\n", cv) : std::string{});
    const auto parsed = sim::parse_scene(text, "ramp_trials.hpp");
    if (!parsed) throw std::runtime_error(parsed.error().message);
    return *parsed;
  }

  RampTrials(double acceleration, double scatter) : acceleration_m_per_s2(acceleration), cv(scatter) {}

  /// \param seeds  first_seed and those after it, one test each.
  void run(std::uint64_t first_seed, int seeds) {
    const sim::Scene ramp = scene();
    sim::SceneRun run{ramp, ramp.scan_rate_Hz};
    for (int i = 0; i < seeds; ++i) {
      run.restart(first_seed + static_cast<std::uint64_t>(i));
      analysis::AnalysisSettings settings;
      settings.tester.speed_course = sim::pull_speed_of(ramp);
      analysis::TestAnalysis analysis{settings};
      base::ScanIndex index = 0;
      std::array<double, 64> raw{};
      while (const std::size_t count = run.next(raw)) {
        for (std::size_t k = 0; k < count; ++k, ++index) analysis.add(index, raw[k], false);
      }
      const analysis::TestResults results = analysis.finish();
      take(results, analysis.cycles());
    }
  }

  /// Bias of S − K pooled over all slips.
  [[nodiscard]] double pooled_bias() const noexcept { return pooled / pooled_count - 1.0; }
  /// Rms error of a test's S − K in terms of CV/√N; of the noise alone where the paper does not scatter.
  [[nodiscard]] double rms_over_sampling() const noexcept {
    return std::sqrt(error_squares / delta_mu.count);
  }

 private:
  void take(const analysis::TestResults& results, const base::LongColumn<detect::Cycle>& cycles) {
    ++tests;
    if (!results.omega.value) {
      ++without_delta_mu;
      return;
    }
    double count = 0.0;
    bool first = true;
    for (const detect::Cycle& cycle : cycles) {
      if (std::isfinite(cycle.delta_mu) && !first) {
        pooled += cycle.delta_mu / kDeltaMu;
        count += 1.0;
      }
      first = false;
    }
    pooled_count += count;
    slips.add(count + 1.0);
    const double ratio = *results.delta_mu.value / kDeltaMu;
    delta_mu.add(ratio);
    delta_mu_z.add((ratio - 1.0) * kDeltaMu / *results.delta_mu.standard_error);
    if (cv > 0.0) error_squares += std::pow((ratio - 1.0) / cv, 2) * count;
    if (!results.escape_speed.value || !results.escape_speed_corrected.value) {
      ++without_escape;
      return;
    }
    const double v_th = threshold_m_per_s();
    escape.add(*results.escape_speed.value / v_th);
    corrected.add(*results.escape_speed_corrected.value / v_th);
    corrected_z.add((*results.escape_speed_corrected.value - v_th) /
                    *results.escape_speed_corrected.standard_error);
  }
};

}  // namespace stickslip::test
