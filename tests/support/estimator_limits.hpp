/// \file
/// How close the estimators come to the least error that any could have: tests of the paper's scene, of
/// which only the noise differs, through the whole analysis. Shared by the numeric test and by the program
/// that prints the table of docs/detector-limits.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/analysis/test_analysis.hpp"
#include "core/estimate/information.hpp"

namespace stickslip::test {

/// What is known before the test.
struct LimitCase {
  bool coupling_known = false;  ///< ω and γ from a ring-down of kRingDown_s, with its errors.
  bool speed_known = false;     ///< Else the stick slope is free.

  [[nodiscard]] std::string name() const {
    return std::string{coupling_known ? "omega, gamma from the tester" : "omega, gamma free"} +
           (speed_known ? ", speed known" : ", stick slope free");
  }
};

inline constexpr std::array<LimitCase, 4> kLimitCases{
    {{false, false}, {true, false}, {false, true}, {true, true}}};

/// Errors of one result over many tests.
struct LimitTally {
  const char* what = "";
  double truth = 0.0;
  double bound = 0.0;  ///< Cramér–Rao, standard error.
  double square_error_sum = 0.0;
  double normalised_sum = 0.0;  ///< Of errors over the standard errors given.
  double normalised_square_sum = 0.0;
  double covered = 0.0;  ///< Tests whose 95 % interval holds the truth.
  double count = 0.0;

  void add(double value, double standard_error) {
    /// Two-sided 95 % of the normal distribution.
    constexpr double k95Percent = 1.959964;
    const double error = value - truth;
    const double z = error / standard_error;
    square_error_sum += error * error;
    normalised_sum += z;
    normalised_square_sum += z * z;
    if (std::abs(z) <= k95Percent) covered += 1.0;
    count += 1.0;
  }
  [[nodiscard]] double rms_over_bound() const { return std::sqrt(square_error_sum / count) / bound; }
  [[nodiscard]] double normalised_mean() const { return normalised_sum / count; }
  [[nodiscard]] double normalised_variance() const {
    return normalised_square_sum / count - normalised_mean() * normalised_mean();
  }
  [[nodiscard]] double coverage() const { return covered / count; }
};

struct LimitReport {
  LimitCase which;
  std::array<LimitTally, 4> tallies;
  int without_result = 0;  ///< Tests without one of the four: must be none.
};

/// S 0.35, K 0.30, 20 Hz, γ/2ω 0.022, 12 in/min, 350 scans/s, 0.001 rms: eleven slips, of which the ten after
/// the first are fitted.
class LimitScene {
 public:
  static constexpr double kSigma = 0.001;
  static constexpr double kScanRate_Hz = 350.0;
  static constexpr int kCycles = 10;
  static constexpr double kRingDown_s = 1.5;
  static constexpr double kInchPerMinute_m_per_s = 0.0254 / 60.0;

  explicit LimitScene(double speed_in_per_min = 12.0) {
    const double omega = 2.0 * std::numbers::pi * 20.0;
    const double speed = speed_in_per_min * kInchPerMinute_m_per_s;
    const auto oscillator = model::Oscillator::from_omega(omega, 0.022);
    parameters_.shared = {omega, oscillator.gamma_per_s,
                          oscillator.stick_rate_per_s(speed, model::kStandardGravity_m_per_s2)};
    speed_over_gravity_s_ = speed / model::kStandardGravity_m_per_s2;
    // The first slip neither on a scan nor half way between two; half a second of rest before the pull.
    parameters_.slip = {(175.3 / kScanRate_Hz) + 0.35 / parameters_.shared.r, 0.35, 0.30};
    const auto course = model::UniformTrajectory::make(parameters_);
    const model::SlipModel slip{parameters_.shared, {0.0, 0.35, 0.30}, true};
    const double peak_s = slip.waveform().peak_time_s();
    const double trough_s = slip.waveform().trough_time_s();
    const double T = course->period_s();
    const double onset_s = parameters_.slip.onset_s;
    // Where the analysis lays its windows: half way up the rise between the first two slips, and the trough
    // of the last slip, after which nothing tells how it went on.
    const double fit_begin_s = onset_s + 0.5 * (trough_s + T + peak_s);
    const double fit_end_s = onset_s + kCycles * T + trough_s;
    // The trace goes on far enough for the last trough to be seen as one.
    const auto scans = static_cast<std::size_t>((onset_s + (kCycles + 1) * T) * kScanRate_Hz);
    for (std::size_t k = 0; k < scans; ++k) {
      const double time_s = static_cast<double>(k) / kScanRate_Hz;
      exact_.push_back(std::max(course->at(time_s).value, 0.0));
      if (time_s >= fit_begin_s && time_s <= fit_end_s) fitted_times_s_.push_back(time_s);
    }
    information_ = estimate::fisher_information(*course, fitted_times_s_, kSigma);
    // The ring-down of the shipped scene: S 0.325 at the same speed.
    std::vector<double> ring_down_times_s;
    for (double t = 0.0; t < kRingDown_s; t += 1.0 / kScanRate_Hz) ring_down_times_s.push_back(t);
    coupling_covariance_ =
        estimate::ring_down_bound(parameters_.shared, {0.02, 0.325, 0.30}, ring_down_times_s, kSigma);
  }

  [[nodiscard]] const Eigen::Matrix2d& coupling_covariance() const { return coupling_covariance_; }
  [[nodiscard]] const std::vector<double>& exact() const { return exact_; }

  [[nodiscard]] estimate::SharedPrior prior(LimitCase which) const {
    estimate::SharedPrior prior;
    const auto& [omega, gamma, r] = parameters_.shared;
    if (which.coupling_known) prior.coupling = {omega, gamma / (2.0 * omega), coupling_covariance_};
    // A millionth of the speed is as good as exact here.
    if (which.speed_known) prior.belt = {speed_over_gravity_s_, 1e-6 * speed_over_gravity_s_};
    return prior;
  }

  [[nodiscard]] estimate::UniformBounds bounds(LimitCase which) const {
    return estimate::cramer_rao_bounds(parameters_, information_, prior(which));
  }

  /// Of S − K where the ring-down tells γ/2ω, the pull speed is known and ω is free.
  [[nodiscard]] double delta_mu_bound_with_gamma_alone() const {
    estimate::SharedPrior prior = this->prior({.coupling_known = true, .speed_known = true});
    const double unknown = prior.coupling->omega;
    prior.coupling->covariance = Eigen::Vector2d{unknown * unknown, coupling_covariance_(1, 1)}.asDiagonal();
    return estimate::cramer_rao_bounds(parameters_, information_, prior).delta_mu;
  }

  /// Of the pull speed, r/ω₀² with ω₀² = ω² + γ²/4, as a part of it; the tester is known.
  [[nodiscard]] double pull_speed_bound() const {
    const auto& [omega, gamma, r] = parameters_.shared;
    model::UniformParameters::Matrix all = information_;
    all.bottomRightCorner<3, 3>() += prior({.coupling_known = true}).at(parameters_.shared).information;
    const double omega0_squared = omega * omega + 0.25 * gamma * gamma;
    const Eigen::Vector3d by{-2.0 * omega / omega0_squared, -0.5 * gamma / omega0_squared, 1.0 / r};
    const Eigen::Matrix3d covariance = all.inverse().bottomRightCorner<3, 3>();
    return std::sqrt(by.dot(covariance * by));
  }

  /// The same case with so many different noises; what is known beforehand has its own error each time.
  [[nodiscard]] LimitReport run(LimitCase which, int seeds, int first_seed = 1) const {
    const estimate::UniformBounds bounds = this->bounds(which);
    LimitReport report;
    report.which = which;
    report.tallies = {{{"S - K", parameters_.slip.S - parameters_.slip.K, bounds.delta_mu},
                       {"K", parameters_.slip.K, bounds.K},
                       {"omega", parameters_.shared.omega, bounds.omega},
                       {"gamma/2omega", parameters_.shared.gamma / (2.0 * parameters_.shared.omega),
                        bounds.gamma_over_2omega}}};
    const Eigen::Matrix2d spread = coupling_covariance_.llt().matrixL();
    for (int seed = first_seed; seed < first_seed + seeds; ++seed) {
      std::mt19937_64 engine{static_cast<std::uint64_t>(seed)};
      std::normal_distribution<double> normal;
      analysis::AnalysisSettings settings;
      settings.scan_rate_Hz = kScanRate_Hz;
      settings.prior = prior(which);
      if (settings.prior.coupling) {
        const double first = normal(engine);
        const double second = normal(engine);
        const Eigen::Vector2d off = spread * Eigen::Vector2d{first, second};
        settings.prior.coupling->omega += off[0];
        settings.prior.coupling->gamma_over_2omega += off[1];
      }
      analysis::TestAnalysis analysis{settings};
      base::ScanIndex index = 0;
      for (const double value : exact_) analysis.add(index++, value + kSigma * normal(engine), false);
      const analysis::TestResults results = analysis.finish();
      const std::array<const analysis::Estimate*, 4> found{&results.delta_mu, &results.mu_k, &results.omega,
                                                           &results.gamma_over_2omega};
      const bool complete = std::all_of(found.begin(), found.end(), [](const analysis::Estimate* estimate) {
        return estimate->value && estimate->standard_error;
      });
      if (!complete) {
        ++report.without_result;
        continue;
      }
      for (std::size_t i = 0; i < found.size(); ++i) {
        report.tallies[i].add(*found[i]->value, *found[i]->standard_error);
      }
    }
    return report;
  }

 private:
  model::UniformParameters parameters_;
  double speed_over_gravity_s_ = 0.0;
  std::vector<double> exact_;
  std::vector<double> fitted_times_s_;
  model::UniformParameters::Matrix information_;
  Eigen::Matrix2d coupling_covariance_;
};

}  // namespace stickslip::test
