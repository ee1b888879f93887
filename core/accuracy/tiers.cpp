#include "core/accuracy/tiers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <random>

#include <Eigen/LU>

#include "core/accuracy/least_time.hpp"
#include "core/detect/live_detector.hpp"
#include "core/estimate/cycle_fit.hpp"
#include "core/estimate/sampling.hpp"
#include "core/model/tester.hpp"
#include "core/model/uniform_trajectory.hpp"

namespace stickslip::accuracy {
namespace {

constexpr std::array<double, 5> kScanRates_Hz{50.0, 100.0, 350.0, 1000.0, 10'000.0};
constexpr double kFrequency_Hz = 20.0;
constexpr double kGammaOver2Omega = 0.022;
constexpr double kS = 0.35;
constexpr double kK = 0.30;
constexpr double kSpeed_m_per_s = 12.0 * 0.0254 / 60.0;
constexpr double kSigma = 0.001;
constexpr int kCycles = 11;
/// 20 tests have 200 cycles: an sd is known to 5 %.
constexpr int kTests = 20;
/// Standard errors of ω and γ/2ω from a ring-down of 1.5 s, in parts (docs/detector.md).
constexpr double kOmegaError = 1.3e-4;
constexpr double kGammaError = 5.1e-3;

model::SharedParameters shared() {
  const double omega = 2.0 * std::numbers::pi * kFrequency_Hz;
  const auto oscillator = model::Oscillator::from_omega(omega, kGammaOver2Omega);
  return {omega, oscillator.gamma_per_s,
          oscillator.stick_rate_per_s(kSpeed_m_per_s, model::kStandardGravity_m_per_s2)};
}

estimate::SharedPrior characterised() {
  estimate::SharedPrior prior;
  const double omega = shared().omega;
  prior.coupling = estimate::SharedPrior::Coupling{};
  prior.coupling->omega = omega;
  prior.coupling->gamma_over_2omega = kGammaOver2Omega;
  prior.coupling->covariance =
      Eigen::Vector2d{std::pow(kOmegaError * omega, 2), std::pow(kGammaError * kGammaOver2Omega, 2)}
          .asDiagonal();
  return prior;
}

/// Rest, loading and kCycles slips; where between two scans the first begins is drawn.
std::vector<double> one_test(double scan_rate_Hz, std::uint64_t seed) {
  std::mt19937_64 engine{seed};
  std::normal_distribution<double> noise{0.0, kSigma};
  const double rest_s = (80.0 + std::uniform_real_distribution<double>{}(engine)) / scan_rate_Hz;
  model::UniformParameters parameters{shared(), {rest_s + kS / shared().r, kS, kK}};
  const auto course = model::UniformTrajectory::make(parameters);
  const auto count =
      static_cast<std::size_t>((parameters.slip.onset_s + kCycles * course->period_s()) * scan_rate_Hz);
  std::vector<double> scans(count);
  for (std::size_t k = 0; k < count; ++k) {
    scans[k] = std::max(course->at(static_cast<double>(k) / scan_rate_Hz).value, 0.0) + noise(engine);
  }
  return scans;
}

/// Of S − K of one cycle, from the middle of a stick to the middle of the next.
double bound_of_a_cycle(double scan_rate_Hz) {
  const model::UniformParameters parameters{shared(), {0.0, kS, kK}};
  const double period_s = model::UniformTrajectory::make(parameters)->period_s();
  const model::SlipModel slip{parameters.shared, parameters.slip, true};
  const double begin_s = -0.5 * (period_s - slip.capture_s());
  double variance = 0.0;
  // Over where the onset may lie between two scans.
  constexpr int kPhases = 8;
  for (int phase = 0; phase < kPhases; ++phase) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (double t = begin_s + phase / (kPhases * scan_rate_Hz); t < begin_s + period_s;
         t += 1.0 / scan_rate_Hz) {
      const Eigen::Vector3d by = slip.at(t).by_slip();
      information += by * by.transpose() / (kSigma * kSigma);
    }
    const Eigen::Matrix3d covariance = information.inverse();
    variance += (covariance(1, 1) + covariance(2, 2) - 2.0 * covariance(1, 2)) / kPhases;
  }
  return std::sqrt(variance);
}

/// S − K of each cycle but the first.
using Estimates = std::vector<double>;

Estimates live(const std::vector<double>& scans, double scan_rate_Hz, detect::EstimatorTier tier) {
  detect::LiveDetector detector{{scan_rate_Hz, 0.0, tier, characterised(), true}};
  Estimates found;
  const auto keep = [&](const std::optional<detect::LiveCycle>& cycle) {
    if (cycle && cycle->cycle.number > 0 && std::isfinite(cycle->cycle.delta_mu))
      found.push_back(cycle->cycle.delta_mu);
  };
  for (const double scan : scans) keep(detector.add(scan, false));
  keep(detector.end());
  return found;
}

/// Of the whole test one number: its largest scan, less the mean of the scans from there on.
Estimates raw_maximum(const std::vector<double>& scans) {
  const auto largest = std::max_element(scans.begin(), scans.end());
  const double mean = std::accumulate(largest, scans.end(), 0.0) / static_cast<double>(scans.end() - largest);
  return {*largest - mean};
}

TierScene scene_at(double scan_rate_Hz) {
  TierScene scene{scan_rate_Hz, kFrequency_Hz, {}};
  for (int test = 1; test <= kTests; ++test)
    scene.tests.push_back(one_test(scan_rate_Hz, static_cast<std::uint64_t>(test)));
  return scene;
}

TierRow empty_row(double scan_rate_Hz, std::string_view name) {
  TierRow row;
  row.scan_rate_Hz = scan_rate_Hz;
  row.scans_per_cycle = scan_rate_Hz / kFrequency_Hz;
  row.estimator = name;
  return row;
}

void judge(TierRow& row, const Estimates& estimates) {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (const double found : estimates) {
    const double error = found / (kS - kK) - 1.0;
    count += 1.0;
    sum += error;
    squares += error * error;
  }
  if (count < 2.0) {
    row.reason = "no estimate";
    return;
  }
  row.bias = sum / count;
  row.deviation = std::sqrt(std::max(squares - sum * sum / count, 0.0) / (count - 1.0));
  row.over_bound = row.deviation * (kS - kK) / bound_of_a_cycle(row.scan_rate_Hz);
}

constexpr double kNanosecondsPerMicrosecond = 1e3;

template <typename Estimator>
TierRow row_of(const TierScene& scene, std::string_view name, const base::Clock& clock,
               const Estimator& estimator) {
  TierRow row = empty_row(scene.scan_rate_Hz, name);
  Estimates estimates;
  for (const std::vector<double>& scans : scene.tests) {
    const Estimates found = estimator(scans);
    estimates.insert(estimates.end(), found.begin(), found.end());
  }
  judge(row, estimates);
  if (!row.reason.empty()) return row;
  const std::int64_t time_ns =
      least_time_ns(clock, [&] { static_cast<void>(estimator(scene.tests.front())); });
  row.us_per_cycle = static_cast<double>(time_ns) / kNanosecondsPerMicrosecond / kCycles;
  return row;
}

TierRow peer_row(const TierScene& scene, std::string_view name, const PeerOutcome& outcome) {
  TierRow row = empty_row(scene.scan_rate_Hz, name);
  judge(row, outcome.estimates);
  if (!row.reason.empty()) return row;
  row.us_per_cycle = outcome.ns_per_scan * static_cast<double>(scene.tests.front().size()) /
                     kNanosecondsPerMicrosecond / kCycles;
  return row;
}

}  // namespace

std::vector<TierRow> compare_tiers(const base::Clock& clock, const Peer& peer) {
  constexpr std::string_view kRawMaximum = "raw maximum of the test";
  std::vector<TierRow> rows;
  std::vector<TierScene> scenes;
  for (const double rate_Hz : kScanRates_Hz) {
    const estimate::SamplingVerdict verdict = estimate::check_sampling(rate_Hz, kFrequency_Hz);
    if (verdict.kind != estimate::SamplingVerdict::Kind::kRefused) {
      scenes.push_back(scene_at(rate_Hz));
      continue;
    }
    rows.push_back(empty_row(rate_Hz, "all"));
    rows.back().reason = verdict.reason;
  }
  const base::Result<std::vector<PeerOutcome>> outcomes = peer.run(scenes);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const TierScene& scene = scenes[i];
    rows.push_back(row_of(scene, kRawMaximum, clock, raw_maximum));
    if (outcomes) {
      rows.push_back(peer_row(scene, peer.name, (*outcomes)[i]));
    } else {
      rows.push_back(empty_row(scene.scan_rate_Hz, peer.name));
      rows.back().reason = outcomes.error().message;
    }
    for (const auto& [tier, name] : detect::kEstimatorTierNames) {
      rows.push_back(row_of(scene, name, clock, [&scene, tier = tier](const std::vector<double>& scans) {
        return live(scans, scene.scan_rate_Hz, tier);
      }));
    }
  }
  return rows;
}

}  // namespace stickslip::accuracy
