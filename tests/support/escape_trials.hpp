/// \file
/// Random tests on a characterised tester: how soon is an escape declared, and how often a captured slip is
/// taken for one.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <thread>
#include <vector>

#include "cli/sweep/scene_scans.hpp"

#include "core/detect/live_detector.hpp"
#include "core/model/threshold.hpp"
#include "core/sim/scene.hpp"
#include "core/sim/scene_truth.hpp"
#include "tests/support/characterised.hpp"
#include "tests/support/random_tests.hpp"

namespace stickslip::test {

/// Of one random test.
struct EscapeTrial {
  int captured = 0;             ///< Slips that ended in sticking,
  int false_escapes = 0;        ///< and declarations of an escape before there was one.
  bool escapes = false;         ///< A slip went on freely for three periods at least.
  double over_threshold = 0.0;  ///< Q/Q_th of that slip,
  double noise = 0.0;           ///< and the noise of a scan over its S − K.
  bool first = false;           ///< It was the first slip of the test.
  /// Of that slip, from its onset to the declaration; infinite if there was none.
  double periods = 0.0;
};

inline EscapeTrial escape_trial(const sim::Scene& scene, const Disturbance& disturbance) {
  EscapeTrial trial;
  const model::TestTruth truth = sim::scene_truth(scene, scene.scan_rate_Hz, scene.seed);
  const double pull_end_s = sim::pull_of(scene)->end_s;
  const double period_s = 2.0 * std::numbers::pi / truth.omega_rad_per_s;
  trial.captured = captures(truth, *sim::pull_of(scene));

  double escape_s = pull_end_s;  // No slip that begins later is asked about.
  if (truth.cycles.empty()) {
    // The start of the belt left it sliding: there is no capture that could be mistaken.
    escape_s = 0.0;
  } else if (static_cast<std::size_t>(trial.captured) < truth.cycles.size()) {
    const model::TrueCycle slip = truth.cycles[static_cast<std::size_t>(trial.captured)];
    escape_s = slip.onset_time_s;
    trial.escapes = escape_s + 3.0 * period_s <= pull_end_s;
    trial.first = trial.captured == 0;
    const double own = slip.mu_s - slip.mu_k;
    trial.over_threshold = scene.constant_speed->pull_speed_m_per_s /
                           model::threshold_speed_m_per_s(scene.oscillator, own, scene.gravity_m_per_s2);
    trial.noise = disturbance.noise * (scene.mu_s - scene.mu_k) / own;
  }

  const daq::Calibration calibration = sweep::calibration_of(scene);
  detect::LiveSettings settings;
  settings.scan_rate_Hz = scene.scan_rate_Hz;
  settings.step_coefficient = calibration.step_coefficient();
  settings.prior =
      characterised(scene.oscillator.omega_rad_per_s(), scene.oscillator.gamma_over_2omega(), scene.seed);
  detect::LiveDetector detector{settings};
  model::Regime before = model::Regime::kUndecided;
  std::optional<double> declared_s;
  const auto add = [&](base::ScanIndex scan, double coefficient, bool saturated) {
    detector.add(coefficient, saturated);
    const model::Regime now = detector.state().regime;
    if (now == before) return;
    before = now;
    const double now_s = static_cast<double>(scan) / scene.scan_rate_Hz;
    if (now != model::Regime::kRingDown || now_s > pull_end_s) return;
    if (now_s < escape_s) {
      ++trial.false_escapes;
    } else if (!declared_s) {
      declared_s = now_s;
    }
  };
  sweep::play(scene, scene.seed, calibration, add,
              [&](base::ScanIndex /*first*/, std::int64_t count) { detector.gap(count); });
  trial.periods = declared_s ? (*declared_s - escape_s) / period_s : HUGE_VAL;
  return trial;
}

/// Trials 0 … count − 1 of this seed on all processors; the same for any number of them.
inline std::vector<EscapeTrial> escape_trials(const sim::Scene& base, const Disturbance& disturbance,
                                              std::size_t count, std::uint64_t seed) {
  std::vector<EscapeTrial> trials(count);
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> threads;
  for (unsigned i = 0; i < std::max(std::thread::hardware_concurrency(), 1U); ++i) {
    threads.emplace_back([&] {
      for (std::size_t n = next++; n < count; n = next++) {
        trials[n] = escape_trial(random_test(base, disturbance, sim::stream_seed(seed, n)), disturbance);
      }
    });
  }
  threads.clear();
  return trials;
}

}  // namespace stickslip::test
