#include "core/analysis/cycle_features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "core/model/inversion.hpp"
#include "core/model/turned_basis.hpp"

namespace stickslip::analysis {
namespace {

/// Features of a cycle: half range, period, largest slip speed over belt speed, mean.
constexpr Eigen::Index kFeatureCount = 4;
using Features = Eigen::Matrix<double, kFeatureCount, 1>;
constexpr Eigen::Index kAmplitude = 0;
constexpr Eigen::Index kPeriod = 1;
constexpr Eigen::Index kSlipSpeed = 2;
constexpr Eigen::Index kMean = 3;

/// Width of the interval about a turning point, or the steepest point, to which a sinusoid is fitted: two
/// radians, which every slip exceeds, and at least one scan more than the fitted parameters. The width must
/// not depend on S − K: to leave out slips that are short of scans would leave out those with a large S − K.
constexpr double kWidth_rad = 2.0;
constexpr std::size_t kFewestFitted = 4;

/// Largest distance of neighbouring scans within a cycle, in scan periods; a larger one is a gap.
constexpr double kGapFromScans = 1.5;

struct Shared {
  model::SharedParameters parameters;
  Eigen::Matrix3d covariance;  ///< Of (ω, γ, r).
};

Shared shared_of(const SlipEstimates& estimates) {
  if (!estimates.uniform) return {estimates.fit.shared, estimates.fit.shared_covariance};
  return {estimates.uniform->parameters.shared, estimates.uniform->covariance.bottomRightCorner<3, 3>()};
}

/// Value and rate of the slip at one place.
struct Local {
  double value = 0.0;
  double rate_per_s = 0.0;
};

/// A damped sinusoid of known ω and γ about any level, laid by least squares through the scans in [from, to]
/// and evaluated at a place that does not depend on their noise: linear, so without bias.
std::optional<Local> local_fit(const estimate::Trace& trace, double from_s, double to_s, double at_s,
                               const model::SharedParameters& shared, model::TurnedBasis& basis,
                               std::size_t near) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (std::size_t k = estimate::scan_at_or_after(trace, from_s, near);
       k < trace.size() && trace.time_s[k] <= to_s; ++k) {
    if (trace.usable[k] == 0) continue;
    const model::DampedBasis at = basis.at(trace.time_s[k] - at_s);
    const Eigen::Vector3d row{1.0, at.cosine, shared.omega * at.sine};
    normal += row * row.transpose();
    right += row * trace.level(k);
    ++count;
  }
  if (count < kFewestFitted) return std::nullopt;
  const Eigen::Vector3d p = normal.colPivHouseholderQr().solve(right);
  if (!p.allFinite()) return std::nullopt;
  return Local{p[0] + p[1], shared.omega * p[2] - 0.5 * shared.gamma * p[1]};
}

/// Mean of the level between two times, straight from scan to scan: a slip begins and ends with the same
/// slope, so that the error of the trapezia cancels [Euler and Maclaurin].
std::optional<double> mean_between(const estimate::Trace& trace, double from_s, double to_s, double scan_s,
                                   std::size_t near) {
  std::size_t k = estimate::scan_at_or_after(trace, from_s, near);
  if (k == 0 || !(to_s > from_s) || to_s > trace.time_s.back()) return std::nullopt;
  double integral = 0.0;
  double done_s = from_s;
  for (; done_s < to_s; ++k) {
    const double left_s = trace.time_s[k - 1];
    const double right_s = trace.time_s[k];
    if (right_s - left_s > kGapFromScans * scan_s) return std::nullopt;
    const double stop_s = std::min(right_s, to_s);
    const double left = trace.level(k - 1);
    const double slope = (trace.level(k) - left) / (right_s - left_s);
    const double middle_s = 0.5 * (done_s + stop_s);
    integral += (left + slope * (middle_s - left_s)) * (stop_s - done_s);
    done_s = stop_s;
  }
  return integral / (to_s - from_s);
}

std::optional<Features> features_of(const estimate::Trace& trace, const model::SlipModel& model,
                                    double onset_s, double next_onset_s,
                                    const model::SharedParameters& shared, model::TurnedBasis& basis,
                                    double scan_s, std::size_t near) {
  const model::SlipWaveform& slip = model.waveform();
  const double width_s = std::max(kWidth_rad / shared.omega, static_cast<double>(kFewestFitted + 1) * scan_s);
  if (width_s > model.capture_s()) return std::nullopt;
  const auto fit_at = [&](double tau_s) {
    const double begin_s = std::clamp(tau_s - 0.5 * width_s, 0.0, model.capture_s() - width_s);
    return local_fit(trace, onset_s + begin_s, onset_s + begin_s + width_s, onset_s + tau_s, shared, basis,
                     near);
  };
  const auto peak = fit_at(slip.peak_time_s());
  const auto steepest = fit_at(slip.fastest_slip_time_s());
  const auto trough = fit_at(slip.trough_time_s());
  const auto mean = mean_between(trace, onset_s, next_onset_s, scan_s, near);
  if (!peak || !steepest || !trough || !mean) return std::nullopt;
  Features features;
  features << 0.5 * (peak->value - trough->value), next_onset_s - onset_s, -steepest->rate_per_s / shared.r,
      *mean;
  return features;
}

struct Cycles {
  std::vector<Features> features;
  double drift_sum = 0.0;  ///< Of the onsets: levels are without it.
};

Cycles cycles_of(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                 const SlipEstimates& estimates, const model::SharedParameters& shared) {
  Cycles found;
  model::TurnedBasis basis{shared.oscillator()};
  const double scan_s = (trace.time_s.back() - trace.time_s.front() - trace.lost_s) /
                        static_cast<double>(std::max<std::size_t>(trace.size(), 2) - 1);
  for (std::size_t i = estimates.first_counts ? 0 : 1; i + 1 < slips.size(); ++i) {
    if (i > 0 && estimates.ends[i - 1] != SlipEnd::kCaptured) continue;
    if (estimates.ends[i] != SlipEnd::kCaptured) continue;
    if (!estimates.has_window(i) || !estimates.has_window(i + 1)) continue;
    const estimate::SlipWindow& window = estimates.windows[estimates.window_of_slip[i]];
    const estimate::SlipWindow& next = estimates.windows[estimates.window_of_slip[i + 1]];
    const model::SlipModel model{estimates.fit.shared, window.slip, true};
    const auto near = static_cast<std::size_t>(slips[i].peak_at);
    if (const auto features =
            features_of(trace, model, window.slip.onset_s, next.slip.onset_s, shared, basis, scan_s, near)) {
      found.features.push_back(*features);
      found.drift_sum += trace.drift.at(window.slip.onset_s);
    }
  }
  return found;
}

/// S − K three times and K, from the features and what all slips share.
struct Numbers {
  Features value;
  std::array<double, 3> condition{};
};

/// \param feature  kAmplitude, kPeriod or kSlipSpeed.
/// \param near  of another cycle.
std::optional<model::InvertedSpeed> inverse_of(Eigen::Index feature, double value,
                                               const model::SharedParameters& shared,
                                               const std::optional<model::InvertedSpeed>& near = {}) {
  const double t = shared.gamma / (2.0 * shared.omega);
  switch (feature) {
    case kAmplitude:
      return model::Q_of_amplitude(value * shared.omega / shared.r, t, near);
    case kPeriod:
      return model::Q_of_period(shared.omega * value, t);
    default:
      return model::Q_of_slip_speed_ratio(value, t, near);
  }
}

/// \return nothing where a feature has no inverse. K has the excess of the mean by `delta_mu`.
std::optional<Numbers> numbers_of(const Features& features, const model::SharedParameters& shared,
                                  double delta_mu) {
  const double belt = shared.r / shared.omega;
  const auto excess = model::cycle_mean_excess(belt / delta_mu, shared.gamma / (2.0 * shared.omega));
  if (!excess) return std::nullopt;
  Numbers numbers;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto speed = inverse_of(i, features[i], shared);
    if (!speed) return std::nullopt;
    numbers.value[i] = belt / speed->Q;
    numbers.condition[static_cast<std::size_t>(i)] = speed->condition;
  }
  numbers.value[kMean] = features[kMean] - *excess * delta_mu;
  return numbers;
}

/// S − K is no straight line in amplitude and slip speed: where slips differ, its mean is the mean of each
/// slip's own. (A period belongs to two slips, and is nearly straight.)
void average_each(const std::vector<Features>& cycles, const model::SharedParameters& shared,
                  Numbers& numbers) {
  const double belt = shared.r / shared.omega;
  for (const Eigen::Index i : {kAmplitude, kSlipSpeed}) {
    double sum = 0.0;
    const auto first = inverse_of(i, cycles.front()[i], shared);
    for (const Features& cycle : cycles) {
      const auto speed = inverse_of(i, cycle[i], shared, first);
      if (!speed) return;  // Noise, close to the threshold: the mean has to do.
      sum += belt / speed->Q;
    }
    numbers.value[i] = sum / static_cast<double>(cycles.size());
  }
}

/// Covariance of the mean features, by their scatter from cycle to cycle and that of neighbours: a late onset
/// lengthens one period and shortens the next. Of no combination less than the two ends alone would leave.
Eigen::Matrix4d mean_covariance(const std::vector<Features>& cycles, const Features& mean) {
  const auto n = static_cast<double>(cycles.size());
  Eigen::Matrix4d own = Eigen::Matrix4d::Zero();
  Eigen::Matrix4d neighbours = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const Features off = cycles[i] - mean;
    own += off * off.transpose() / (n - 1.0);
    if (i + 1 < cycles.size()) neighbours += off * (cycles[i + 1] - mean).transpose() / (n - 1.0);
  }
  const Features scale = own.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::Matrix4d correlation = scale.cwiseInverse().asDiagonal() *
                                      (own + neighbours + neighbours.transpose()) *
                                      scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver{correlation};
  const Eigen::Matrix4d kept = solver.eigenvectors() * solver.eigenvalues().cwiseMax(1.0 / n).asDiagonal() *
                               solver.eigenvectors().transpose();
  return scale.asDiagonal() * kept * scale.asDiagonal() / n;
}

}  // namespace

void no_feature_results(const std::string& reason, TestResults& results) {
  for (Estimate* estimate :
       {&results.mu_k_from_mean, &results.mu_s_from_amplitude, &results.delta_mu_from_amplitude,
        &results.delta_mu_from_timing, &results.delta_mu_from_slip_speed, &results.delta_mu_combined}) {
    *estimate = Estimate::none(reason);
  }
}

void feature_results(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                     const SlipEstimates& estimates, TestResults& results) {
  const auto captured = std::count(estimates.ends.begin(), estimates.ends.end(), SlipEnd::kCaptured);
  if (captured == 0) return no_feature_results("no sticking seen after a slip", results);
  const auto [shared, shared_covariance] = shared_of(estimates);
  const Cycles found = cycles_of(trace, slips, estimates, shared);
  const std::vector<Features>& cycles = found.features;
  if (cycles.size() < kFewestFeatureCycles) {
    return no_feature_results(fmt::format("{} cycles from stick to stick after the first, {} are needed",
                                          cycles.size(), kFewestFeatureCycles),
                              results);
  }
  if (!results.delta_mu.value || !(*results.delta_mu.value > 0.0)) {
    return no_feature_results("S - K is not positive", results);
  }
  if (!(shared.gamma >= 0.0))
    return no_feature_results(fmt::format("the damping found, {:.3g}, is negative", shared.gamma), results);

  Features mean = Features::Zero();
  for (const Features& cycle : cycles) mean += cycle / static_cast<double>(cycles.size());
  const double delta_mu = *results.delta_mu.value;
  const Eigen::Matrix4d covariance = mean_covariance(cycles, mean);
  auto numbers = numbers_of(mean, shared, delta_mu);
  if (!numbers)
    return no_feature_results("amplitude, period or slip speed are not those of stick-slip", results);

  // By features, then by (ω, γ, r), by central differences.
  Eigen::Matrix<double, kFeatureCount, kFeatureCount + 3> slope;
  slope.setZero();
  for (Eigen::Index i = 0; i < slope.cols(); ++i) {
    const double variance =
        i < kFeatureCount ? covariance(i, i) : shared_covariance(i - kFeatureCount, i - kFeatureCount);
    const double step = 0.01 * std::sqrt(variance);
    if (!(step > 0.0)) continue;
    const auto moved = [&, &shared = shared](double by) {
      Features features = mean;
      Eigen::Vector3d p{shared.omega, shared.gamma, shared.r};
      if (i < kFeatureCount) {
        features[i] += by;
      } else {
        p[i - kFeatureCount] += by;
        // The ratio was taken with the r given.
        features[kSlipSpeed] *= shared.r / p[2];
      }
      return numbers_of(features, {p[0], p[1], p[2]}, delta_mu);
    };
    const auto up = moved(step);
    const auto down = moved(-step);
    if (!up || !down) return no_feature_results("too close to the threshold to be inverted", results);
    slope.col(i) = (up->value - down->value) / (2.0 * step);
  }
  average_each(cycles, shared, *numbers);
  const Eigen::Matrix4d by_features =
      slope.leftCols<kFeatureCount>() * covariance * slope.leftCols<kFeatureCount>().transpose();
  const Eigen::Matrix<double, kFeatureCount, 3> by_shared = slope.rightCols<3>();
  const Eigen::Matrix4d total = by_features + by_shared * shared_covariance * by_shared.transpose();
  const double drift = found.drift_sum / static_cast<double>(cycles.size());
  const auto combined = [&](const Features& weight) {
    return Estimate::of(weight.dot(numbers->value) + weight[kMean] * drift,
                        std::sqrt(weight.dot(total * weight)));
  };
  results.delta_mu_from_amplitude = combined(Features::Unit(kAmplitude));
  results.delta_mu_from_timing = combined(Features::Unit(kPeriod));
  results.delta_mu_from_slip_speed = combined(Features::Unit(kSlipSpeed));
  // Condition number times the relative error of the number read is the relative error of S − K.
  Features weight = Features::Zero();
  for (const Eigen::Index i : {kAmplitude, kPeriod, kSlipSpeed}) {
    const double error =
        numbers->condition[static_cast<std::size_t>(i)] * std::sqrt(covariance(i, i)) / mean[i];
    weight[i] = 1.0 / (error * error);
  }
  weight /= weight.sum();
  results.delta_mu_combined =
      weight.allFinite() ? combined(weight) : Estimate::none("the cycles do not scatter at all");
  results.mu_k_from_mean = combined(Features::Unit(kMean));
  results.mu_s_from_amplitude = combined(Features::Unit(kMean) + Features::Unit(kAmplitude));
}

}  // namespace stickslip::analysis
