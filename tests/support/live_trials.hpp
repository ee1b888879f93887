/// \file
/// Simulated tests for the live detector, of any scan rate and length: rest, loading, sticks and slips, and
/// an escape at a slip that is told beforehand. From the closed forms, scan by scan.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "core/detect/live_detector.hpp"
#include "core/model/slip_model.hpp"
#include "tests/support/characterised.hpp"

namespace stickslip::test {

/// What is pulled, by what.
struct LiveScene {
  double scan_rate_Hz = 350.0;
  double frequency_Hz = 20.0;
  double gamma_over_2omega = 0.022;
  double S = 0.35;
  double K = 0.30;
  double Q = 1.309;  ///< 12 in/min
  double sigma = 0.001;
  double scatter = 0.0;   ///< Of ln(S − K) from slip to slip.
  int slips = 11;         ///< Captured ones.
  double escape_Q = 0.0;  ///< Of one more slip, which is not captured; 0: there is none.
  double escape_periods = 20.0;
  std::uint64_t seed = 1;

  [[nodiscard]] double omega() const { return 2.0 * std::numbers::pi * frequency_Hz; }
  [[nodiscard]] model::SharedParameters shared() const {
    return {omega(), 2.0 * gamma_over_2omega * omega(), Q * omega() * (S - K)};
  }
  /// ω and γ from a ring-down, with its error.
  [[nodiscard]] estimate::SharedPrior characterised() const {
    return test::characterised(omega(), gamma_over_2omega, seed);
  }
};

class LiveTrial {
 public:
  struct TrueSlip {
    double onset_s;
    double S;
    double K;
    bool captured;
  };

  explicit LiveTrial(const LiveScene& scene) : scene_(scene), engine_(scene.seed) {
    const model::SharedParameters shared = scene.shared();
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> part;
    // The noise must be known before the first slip; and the first onset lies anywhere between two scans.
    begin_s_ = (80.0 + part(engine_)) / scene.scan_rate_Hz;
    double from_s = begin_s_;  // Where the stick's line would be at zero.
    for (int i = 0; i < scene.slips + (scene.escape_Q > 0.0 ? 1 : 0); ++i) {
      const bool escapes = i == scene.slips;
      double D = (scene.S - scene.K) * std::exp(scene.scatter * normal(engine_));
      if (escapes) D = (scene.S - scene.K) * scene.Q / scene.escape_Q;
      TrueSlip slip{from_s + (scene.K + D) / shared.r, scene.K + D, scene.K, !escapes};
      models_.emplace_back(shared, model::SlipParameters{slip.onset_s, slip.S, slip.K}, !escapes);
      slips_.push_back(slip);
      if (escapes) {
        end_s_ = slip.onset_s + scene.escape_periods / scene.frequency_Hz;
        break;
      }
      const double capture_s = slip.onset_s + models_.back().capture_s();
      from_s = capture_s - models_.back().at(capture_s).value / shared.r;
      end_s_ = capture_s;
    }
  }

  [[nodiscard]] const std::vector<TrueSlip>& slips() const { return slips_; }
  [[nodiscard]] std::int64_t scan_count() const {
    return static_cast<std::int64_t>(end_s_ * scene_.scan_rate_Hz);
  }
  [[nodiscard]] double time_s(std::int64_t scan) const {
    return static_cast<double>(scan) / scene_.scan_rate_Hz;
  }
  /// Scans in their order.
  [[nodiscard]] double next() {
    const double t = time_s(scan_++);
    while (now_ + 1 < slips_.size() && t > half_way(now_)) ++now_;
    const double value = t < begin_s_ ? 0.0 : models_[now_].at(t).value;
    return value + scene_.sigma * noise_(engine_);
  }

 private:
  /// In the stick after a slip.
  [[nodiscard]] double half_way(std::size_t slip) const {
    return 0.5 * (slips_[slip].onset_s + models_[slip].capture_s() + slips_[slip + 1].onset_s);
  }

  LiveScene scene_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> noise_;
  std::vector<TrueSlip> slips_;
  std::vector<model::SlipModel> models_;
  double begin_s_ = 0.0;
  double end_s_ = 0.0;
  std::int64_t scan_ = 0;
  std::size_t now_ = 0;
};

/// What came of a trial.
struct LiveOutcome {
  std::vector<detect::LiveCycle> cycles;
  double escape_declared_s = std::nan("");  ///< First time that the regime was ring-down.
  double sliding_declared_s = std::nan("");
  int false_escapes = 0;  ///< Captured slips that were taken for escapes.
};

inline LiveOutcome run_live(const LiveScene& scene, const detect::LiveSettings& settings) {
  LiveTrial trial{scene};
  detect::LiveDetector detector{settings};
  LiveOutcome outcome;
  model::Regime before = model::Regime::kUndecided;
  const double escape_s = scene.escape_Q > 0.0 ? trial.slips().back().onset_s : 1e300;
  for (std::int64_t scan = 0; scan < trial.scan_count(); ++scan) {
    if (const auto cycle = detector.add(trial.next(), false)) outcome.cycles.push_back(*cycle);
    const model::Regime regime = detector.state().regime;
    if (regime == before) continue;
    before = regime;
    const double now_s = trial.time_s(scan);
    if (regime == model::Regime::kSteadySliding) outcome.sliding_declared_s = now_s;
    if (regime != model::Regime::kRingDown) continue;
    if (now_s < escape_s) {
      ++outcome.false_escapes;
    } else if (std::isnan(outcome.escape_declared_s)) {
      outcome.escape_declared_s = now_s;
    }
  }
  if (const auto last = detector.end()) outcome.cycles.push_back(*last);
  return outcome;
}

}  // namespace stickslip::test
