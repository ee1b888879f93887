#include "core/analysis/model_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Core>

#include "core/analysis/covariance_of_means.hpp"
#include "core/analysis/cycle_features.hpp"
#include "core/analysis/escape.hpp"
#include "core/analysis/slip_guess.hpp"
#include "core/analysis/slip_windows.hpp"
#include "core/base/nan.hpp"
#include "core/detect/regime_rule.hpp"
#include "core/estimate/huber.hpp"
#include "core/model/closed_forms.hpp"
#include "core/model/threshold.hpp"
#include "core/model/turned_basis.hpp"
#include "core/signal/statistics.hpp"
#include "core/signal/wandering_mean.hpp"

namespace stickslip::analysis {
namespace {

/// Fewest slips for which means leave out the first, which is often not representative [Penner 1995].
constexpr std::size_t kEnoughToLeaveOutTheFirst = 3;

/// The six numbers from which all else follows, with their covariance: (ω, γ, r, S̄, K̄).
struct Fitted {
  Eigen::Matrix<double, 5, 1> value;
  Eigen::Matrix<double, 5, 5> covariance;
  Eigen::Matrix<double, 5, 5> of_noise;  ///< Covariance without the scatter from slip to slip.
  double beyond_noise = 0.0;             ///< Misfit::beyond_noise()
  signal::WanderingMean D;
  signal::RunningVariance amplitude;
  double drift = 0.0;           ///< Of S and K, where the slips begin in the mean.
  double relative_speed = 1.0;  ///< Mean over the slips, of the speed at which r is given.
};

double half_range(const model::SlipWaveform& slip) {
  return 0.5 * (slip.value(slip.peak_time_s()) - slip.value(slip.trough_time_s()));
}

/// The six numbers of a course that all slips share.
void take(const estimate::UniformFit& uniform, Fitted& fitted) {
  using Uniform = model::UniformParameters;
  constexpr std::array<Eigen::Index, 5> kOrder{Uniform::kOmega, Uniform::kGamma, Uniform::kR, Uniform::kS,
                                               Uniform::kK};
  const Uniform::Vector value = uniform.parameters.vector();
  for (Eigen::Index i = 0; i < 5; ++i) {
    const Eigen::Index from = kOrder[static_cast<std::size_t>(i)];
    fitted.value[i] = value[from];
    for (Eigen::Index j = 0; j < 5; ++j) {
      fitted.covariance(i, j) = uniform.covariance(from, kOrder[static_cast<std::size_t>(j)]);
    }
  }
  fitted.of_noise = fitted.covariance;
}

Fitted gather(const SlipEstimates& estimates) {
  const estimate::SlipFit& fit = estimates.fit;
  const std::vector<estimate::SlipWindow> windows = slips_that_count(estimates);

  Fitted fitted;
  signal::WanderingMean S;
  signal::WanderingMean K;
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
  if (!estimates.belt.is_constant()) fitted.relative_speed = 0.0;
  for (const estimate::SlipWindow& window : windows) {
    // With the drift, which wanders, too: over another stretch of track it would be another one.
    const double drift = estimates.drift.at(window.slip.onset_s);
    S.add(estimates.static_coefficient(window) + drift);
    K.add(window.slip.K + drift);
    fitted.D.add(estimates.static_coefficient(window) - window.slip.K);
    const model::SlipModel model{fit.shared, window.slip, false, estimates.belt};
    fitted.amplitude.add(half_range(model.waveform()));
    if (!estimates.belt.is_constant()) {
      fitted.relative_speed +=
          estimates.belt.relative(window.slip.onset_s) / static_cast<double>(windows.size());
    }
    own += window.inverse_curvature;
    coupling += window.coupling;
    fitted.drift += drift / static_cast<double>(windows.size());
  }
  if (estimates.uniform) {
    take(*estimates.uniform, fitted);
    return fitted;
  }
  const auto n = static_cast<double>(windows.size());
  coupling /= n;
  const Eigen::Matrix<double, 2, 3> pull = coupling.bottomRows<2>();
  const auto covariance = [&](const Eigen::Matrix2d& own_mean) {
    Eigen::Matrix<double, 5, 5> all;
    all.topLeftCorner<3, 3>() = fit.shared_covariance;
    all.bottomLeftCorner<2, 3>() = -pull * fit.shared_covariance;
    all.topRightCorner<3, 2>() = all.bottomLeftCorner<2, 3>().transpose();
    all.bottomRightCorner<2, 2>() = own_mean + pull * fit.shared_covariance * pull.transpose();
    return all;
  };
  Eigen::Matrix2d own_mean = own.bottomRightCorner<2, 2>() / (n * n);
  fitted.of_noise = covariance(own_mean);
  if (windows.size() > 1) {
    // The scatter from slip to slip holds the noise of each and what the paper adds to it.
    own_mean = covariance_of_means(S.error_of_mean(), K.error_of_mean(), fitted.D.error_of_mean());
  }
  fitted.value << fit.shared.omega, fit.shared.gamma, fit.shared.r, S.mean() - fitted.drift,
      K.mean() - fitted.drift;
  fitted.covariance = covariance(own_mean);
  return fitted;
}

/// Value and first-order standard error of function(ω, γ, r, S, K), by central differences with
/// steps of the standard errors themselves (their third root of ε would be too small beside noise).
template <typename Function>
Estimate derived(const Fitted& fitted, const Function& function) {
  Eigen::Matrix<double, 5, 1> gradient = Eigen::Matrix<double, 5, 1>::Zero();
  for (Eigen::Index i = 0; i < 5; ++i) {
    const double step = 0.01 * std::sqrt(fitted.covariance(i, i));
    if (!(step > 0.0)) continue;
    Eigen::Matrix<double, 5, 1> up = fitted.value;
    Eigen::Matrix<double, 5, 1> down = fitted.value;
    up[i] += step;
    down[i] -= step;
    gradient[i] = (function(up) - function(down)) / (2.0 * step);
  }
  Estimate estimate =
      Estimate::of(function(fitted.value), std::sqrt(gradient.dot(fitted.covariance * gradient)));
  if (fitted.beyond_noise > 0.0)
    add_systematic(estimate, UncertaintySource::kMisfit,
                   fitted.beyond_noise * std::sqrt(gradient.dot(fitted.of_noise * gradient)));
  return estimate;
}

/// Part of S − K of an oscillation that never sticks, that creep of the contact before the slip would hide.
/// Its amplitude is √((S − K)² + (u/ω)²) by the speed u of the sled at the onset, that of the belt less the
/// creep. A slip that sticks again tells S − K by its times, too.
double of_creep(double delta_mu, double speed_over_omega) {
  // Assumed: nothing in such a trace tells it. Slow slips of measured paper creep before they begin.
  constexpr double kCreep = 0.05;
  const double slower = 1.0 - kCreep;
  const double known = std::max(delta_mu, 0.0);
  return std::sqrt(known * known + (1.0 - slower * slower) * speed_over_omega * speed_over_omega) - known;
}

model::Oscillator oscillator_of(const Eigen::Matrix<double, 5, 1>& p) {
  return model::Oscillator::from_omega(p[0], p[1] / (2.0 * p[0]));
}

}  // namespace

std::vector<estimate::SlipWindow> slips_that_count(const SlipEstimates& estimates) {
  const std::vector<estimate::SlipWindow>& all = estimates.windows;
  std::vector<estimate::SlipWindow> windows;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool rested_longer =
        i == 0 || estimates.belt.is_held_between(all[i - 1].slip.onset_s, all[i].slip.onset_s);
    if (estimates.first_counts || !rested_longer) windows.push_back(all[i]);
  }
  if (all.size() < kEnoughToLeaveOutTheFirst || windows.empty()) windows = all;
  std::vector<double> sizes;
  sizes.reserve(windows.size());
  for (const estimate::SlipWindow& window : windows) sizes.push_back(std::abs(window.slip.S - window.slip.K));
  const double typical = signal::median(sizes);
  std::vector<estimate::SlipWindow> told;
  std::copy_if(
      windows.begin(), windows.end(), std::back_inserter(told),
      [&](const estimate::SlipWindow& window) { return estimates.fit.delta_mu_error(window) <= typical; });
  return told.empty() ? std::vector<estimate::SlipWindow>{windows.begin(), windows.end()} : told;
}

namespace {

/// Standard errors by which an estimated damping may lie below zero by chance.
constexpr double kNegativeDampingSigmas = 4.0;

/// γ with its standard error.
std::pair<double, double> damping_of(const SlipEstimates& estimates) noexcept {
  using Uniform = model::UniformParameters;
  if (estimates.uniform) {
    return {estimates.uniform->parameters.shared.gamma,
            std::sqrt(estimates.uniform->covariance(Uniform::kGamma, Uniform::kGamma))};
  }
  return {estimates.fit.shared.gamma, std::sqrt(estimates.fit.shared_covariance(1, 1))};
}

/// Friction that falls with speed feeds the oscillation: K is no constant then.
bool feeds_the_oscillation(const SlipEstimates& estimates) noexcept {
  const auto [gamma, error] = damping_of(estimates);
  return gamma < -kNegativeDampingSigmas * error;
}

/// Whether γ reaches the fit's limit 2ω within two standard errors: the scans show no oscillation, or are too
/// few for each.
bool is_overdamped(const SlipEstimates& estimates) noexcept {
  constexpr double kSigmasOfDamping = 2.0;
  const auto [gamma, error] = damping_of(estimates);
  return gamma + kSigmasOfDamping * error > 2.0 * estimates.fit.shared.omega;
}

/// Slips that follow one another faster than the fit's own free oscillation: with rests between them they
/// would come more slowly. \return what contradicts; empty if nothing does.
std::string faster_than_free(const SlipEstimates& estimates) {
  constexpr double kSure = 3.0;
  constexpr double kMargin = 0.05;  // For what the model leaves out.
  const double omega = estimates.fit.shared.omega;
  const double free_s = 2.0 * std::numbers::pi / omega;
  const double share = 1.0 + kMargin + kSure * std::sqrt(estimates.fit.shared_covariance(0, 0)) / omega;
  for (std::size_t i = 0; i + 1 < estimates.ends.size(); ++i) {
    if (estimates.ends[i] != SlipEnd::kCaptured || !estimates.has_window(i) || !estimates.has_window(i + 1))
      continue;
    const estimate::SlipWindow& one = estimates.windows[estimates.window_of_slip[i]];
    const estimate::SlipWindow& next = estimates.windows[estimates.window_of_slip[i + 1]];
    const double period_s = next.slip.onset_s - one.slip.onset_s;
    const double error_s = std::hypot(estimates.fit.onset_error_s(one), estimates.fit.onset_error_s(next));
    if ((period_s + kSure * error_s) * share < free_s) {
      return fmt::format(
          "slips {:.3g} s apart with rests between them cannot come faster than the fit's oscillation, "
          "{:.3g} s",
          period_s, free_s);
    }
  }
  return {};
}

/// A slip whose end contradicts its own numbers: the sled sticks again exactly where Q is below the threshold
/// [22], and without damping always. Asked of ends that are decided, and of oscillations that go on over
/// three slips, where the belt is constant: an acceleration shifts the threshold (docs/ramp.md). γ and Q, by
/// r and S − K, may each be off by kSure standard errors, and Q by kMargin more, for what the model leaves
/// out. \return what contradicts; empty if nothing does.
std::string contradiction(const SlipEstimates& estimates) {
  constexpr double kSure = 3.0;
  constexpr double kMargin = 1.2;
  if (!estimates.belt.is_constant()) return {};
  const double told = std::log(detect::kDecisiveLikelihoodRatio);
  const double omega = estimates.fit.shared.omega;
  const double r = estimates.fit.shared.r;
  const double r_error = std::sqrt(estimates.fit.shared_covariance(2, 2));
  const auto [gamma, gamma_error] = damping_of(estimates);
  const auto threshold = [omega](double damping) {
    return model::Q_threshold(std::clamp(damping / (2.0 * omega), 0.0, model::kLargestGammaOver2Omega));
  };
  const double lowest = threshold(gamma + kSure * gamma_error);
  const double highest = threshold(gamma - kSure * gamma_error);
  for (std::size_t i = 0; i < estimates.log_likelihood_ratios.size(); ++i) {
    const double ratio = estimates.log_likelihood_ratios[i];
    const bool begins_from_stick = i == 0 || estimates.window_of_slip[i] != estimates.window_of_slip[i - 1];
    if (!begins_from_stick || !estimates.has_window(i)) continue;
    const estimate::SlipWindow& window = estimates.windows[estimates.window_of_slip[i]];
    const double D = window.slip.S - window.slip.K;
    const double Q = model::dimensionless_speed(r, omega, std::max(D, 0.0));
    const double D_error = estimates.fit.delta_mu_error(window);
    const double factor = 1.0 + kSure * std::hypot(r_error / r, D_error / D);
    const bool goes_on =
        i + 2 < estimates.ends.size() && estimates.window_of_slip[i + 2] == estimates.window_of_slip[i];
    const bool is_free = estimates.ends[i] == SlipEnd::kFree && (ratio < -told || goes_on);
    if (is_free && kMargin * factor * Q < lowest) {
      return fmt::format(
          "the slip at {:.3f} s went on freely at Q = {:.3g}; with gamma/2omega = {:.2g} it would stick "
          "again",
          window.slip.onset_s, Q, gamma / (2.0 * omega));
    }
    const bool is_captured = estimates.ends[i] == SlipEnd::kCaptured && ratio > told;
    if (is_captured && Q > kMargin * factor * highest) {
      return fmt::format(
          "the slip at {:.3f} s stuck again at Q = {:.3g}; with gamma/2omega = {:.2g} it would go on",
          window.slip.onset_s, Q, gamma / (2.0 * omega));
    }
  }
  return {};
}

/// Standard error of a mean square of noise over σ², both estimated from so many scans.
double error_of_square(double scans) { return std::sqrt((2.0 + kVarianceOfNoise) / std::max(scans, 1.0)); }

/// What in the friction or the trace keeps the fit from an end, by where it stopped.
std::string why_not_converged(const SlipEstimates& estimates, double sigma) {
  const estimate::SlipFit& fit = estimates.fit;
  constexpr double kRanAway = 0.02;  // γ/2ω below zero, and about as much as a tester has above it.
  constexpr double kFlat = 0.5;
  const double damping = fit.shared.gamma / (2.0 * fit.shared.omega);
  if (fit.scan_count == 0) return "the slips have too few scans for a fit";
  if (fit.shared.r < kFlat * estimates.guess.r) {
    return fmt::format(
        "the force rises on no straight line between the slips, as of a sled that hardly rests: the fit's "
        "stick rate ran to {:.2g} of the rises' slope",
        fit.shared.r / estimates.guess.r);
  }
  if (damping < -kRanAway) {
    return fmt::format(
        "the slips begin gradually, or friction falls while the sled slides: the fit's damping ran to "
        "gamma/2omega = {:.2g}",
        damping);
  }
  if (fit.residual_sigma <= sigma)
    return "the fit does not converge: the slips tell too little of the law, as few or small ones do";
  return fmt::format(
      "the slips have another shape than that of constant S and K: residuals of {:.1f} times the scan noise",
      fit.residual_sigma / sigma);
}

/// Why the model does not describe the test; empty if it does.
std::string why_not(const SlipEstimates& estimates, double sigma) {
  const estimate::SlipFit& fit = estimates.fit;
  if (!fit.converged) return why_not_converged(estimates, sigma);
  if (!(fit.residual_sigma <= kLargestResidualSigmas * sigma)) {
    return fmt::format("the model leaves residuals of {:.1f} times the scan noise, {:.0f} are allowed",
                       fit.residual_sigma / sigma, kLargestResidualSigmas);
  }
  const auto [gamma, error] = damping_of(estimates);
  if (is_overdamped(estimates)) {
    return fmt::format(
        "overdamped: gamma/2omega {:.2g} +- {:.1g}, the scans show no oscillation of the model",
        gamma / (2.0 * fit.shared.omega), error / (2.0 * fit.shared.omega));
  }
  if (feeds_the_oscillation(estimates)) {
    return fmt::format(
        "the model does not describe this friction: its damping, {:.2g} +- {:.1g} 1/s, would be negative",
        gamma, error);
  }
  const std::string by_ends = contradiction(estimates);
  return by_ends.empty() ? faster_than_free(estimates) : by_ends;
}

}  // namespace

bool model_describes(const SlipEstimates& estimates, double sigma) {
  return why_not(estimates, sigma).empty();
}

void Misfit::Sum::add(double residual_sigma, double of_freedom) noexcept {
  const double residual = residual_sigma / estimate::kHuberResidualOfNoise;
  squares += residual * residual * of_freedom;
  freedom += of_freedom;
}

double Misfit::residual_of(const Sum& sum) noexcept {
  return sum.freedom > 0.0 ? std::sqrt(sum.squares / sum.freedom) : 0.0;
}

double Misfit::z_of(const Sum& sum) noexcept {
  return (std::pow(residual_of(sum), 2) - 1.0) / error_of_square(sum.freedom);
}

double Misfit::beyond_noise() const noexcept {
  if (!(z_of_mean() > kSignificant)) return 0.0;
  const double ratio = mean_.birge_ratio() / std::max(residual_sigmas(), 1.0);
  return std::sqrt(std::max(ratio * ratio - 1.0, 0.0));
}

void Misfit::Sum::add(const Sum& other) noexcept {
  squares += other.squares;
  freedom += other.freedom;
}

void Misfit::add(const Misfit& others) noexcept {
  converged_ = converged_ && others.converged_;
  whole_.add(others.whole_);
  mean_.add(others.mean_);
  for (std::size_t i = 0; i < parts_.size(); ++i) parts_[i].add(others.parts_[i]);
}

void Misfit::add(const estimate::Trace& trace, const SlipEstimates& estimates, double sigma) {
  const estimate::SlipFit& fit = estimates.fit;
  if (!(fit.freedom > 0.0)) return;
  Sum section;
  section.add(fit.residual_sigma / sigma, fit.freedom);
  whole_.add(fit.residual_sigma / sigma, fit.freedom);
  converged_ = converged_ && fit.converged;
  if (!fit.converged) return;
  model::TurnedBasis basis{fit.shared.oscillator()};
  const double per_s = fit.shared.omega / (2.0 * std::numbers::pi);
  for (const estimate::SlipWindow& window : estimates.windows) {
    mean_.begin_slip();
    const model::SlipModel model{fit.shared, window.slip, window.captured, estimates.belt};
    for (std::size_t k = window.first; k < window.end; ++k) {
      if (trace.usable[k] == 0) continue;
      const double time_s = trace.time_s[k];
      mean_.add((time_s - window.slip.onset_s) * per_s,
                (trace.level(k) - model.place(time_s, basis).value) / sigma);
    }
  }
  if (!(z_of(section) > kSignificant)) return;  // Chance has no place.
  std::array<estimate::HuberSums, kSlipPartNames.size()> sums;
  for (const estimate::SlipWindow& window : estimates.windows) {
    const model::SlipModel model{fit.shared, window.slip, window.captured, estimates.belt};
    const model::SlipWaveform& waveform = model.waveform();
    const double trough_s = waveform.trough_time_s();
    const double trough = waveform.value(trough_s);
    const double drop = waveform.value(waveform.peak_time_s()) - trough;
    const auto part_of = [&](double tau_s, double value) {
      constexpr double kHigh = 0.9;
      constexpr double kLow = 0.1;
      if (tau_s < 0.0 || tau_s > model.capture_s()) return SlipPart::kRise;
      const double height = (value - trough) / drop;
      if (height < kLow) return SlipPart::kTrough;
      if (tau_s > trough_s) return SlipPart::kRise;  // Of a sled that slides on.
      return height > kHigh ? SlipPart::kPeak : SlipPart::kFall;
    };
    for (std::size_t k = window.first; k < window.end; ++k) {
      if (trace.usable[k] == 0) continue;
      const double value = model.place(trace.time_s[k], basis).value;
      const SlipPart part = part_of(trace.time_s[k] - window.slip.onset_s, value);
      sums[static_cast<std::size_t>(part)].add((trace.level(k) - value) / sigma);
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) parts_[i].add(sums[i].residual_sigma(0.0), sums[i].count());
}

std::optional<SlipPart> Misfit::place() const noexcept {
  if (!converged_ || !(z_of(whole_) > kSignificant)) return std::nullopt;
  const auto largest = std::ranges::max_element(parts_, {}, [](const Sum& sum) { return residual_of(sum); });
  if (!(residual_of(*largest) > 0.0)) return std::nullopt;  // Only all sections together tell it.
  return static_cast<SlipPart>(largest - parts_.begin());
}

Estimate Misfit::systematic() const {
  if (!converged_ || whole_.freedom <= 0.0) return Estimate::none("no fit of the model converged");
  const double of_size = residual_sigmas() * residual_sigmas() - 1.0;
  const bool by_mean = repeats() && mean_.square() > of_size;
  const double square = std::max(by_mean ? mean_.square() : of_size, 0.0);
  const double error = by_mean ? mean_.error_of_square(whole_.freedom) : error_of_square(whole_.freedom);
  // Of the root of a square that may be zero.
  return Estimate::of(std::sqrt(square), error / (2.0 * std::sqrt(std::max(square, 0.25 * error))));
}

void no_model_results(const std::string& reason, TestResults& results) {
  for (Estimate* estimate :
       {&results.mu_s, &results.mu_k, &results.delta_mu, &results.omega, &results.gamma_over_2omega,
        &results.Q, &results.Q_threshold, &results.threshold_speed, &results.slip_speed_ratio_threshold,
        &results.amplitude, &results.delta_mu_scatter, &results.escape_speed, &results.escape_speed_corrected,
        &results.pull_speed_measured}) {
    *estimate = Estimate::none(reason);
  }
  no_feature_results(reason, results);
}

void escape_results(const SlipEstimates& estimates, TestResults& results) {
  const auto none = [&](const char* reason) {
    results.escape_speed = results.escape_speed_corrected = Estimate::none(reason);
  };
  if (estimates.belt.is_constant()) return none("no course of the pull speed is known");
  if (!(estimates.fit.shared.gamma > 0.0)) return none("the damping found is not positive");
  const std::optional<double> scatter = delta_mu_scatter(estimates);
  if (!scatter) {
    return none(estimates.windows.size() < 3 ? "fewer than three slips to compare"
                                             : "the mean S - K is not positive");
  }
  const EscapeSpeeds speeds = escape_speeds(escape_trials(estimates), *scatter);
  results.escape_speed = speeds.first_escape;
  results.escape_speed_corrected = speeds.of_mean_paper;
}

void model_results(std::span<const detect::Fall> slips, const SlipEstimates& estimates, const Misfit& misfit,
                   const model::Tester& tester, double sigma, TestResults& results) {
  if (const std::string why = why_not(estimates, sigma); !why.empty()) {
    no_model_results(why, results);
    // The traditional amplitude needs no model.
    signal::RunningVariance amplitude;
    for (const detect::Fall& slip : slips) amplitude.add(0.5 * slip.drop());
    results.amplitude = Estimate::of(amplitude.mean, amplitude.error_of_mean());
    return;
  }
  escape_results(estimates, results);
  Fitted fitted = gather(estimates);
  fitted.beyond_noise = misfit.beyond_noise();
  using P = Eigen::Matrix<double, 5, 1>;
  results.omega = derived(fitted, [](const P& p) { return p[0]; });
  results.gamma_over_2omega = derived(fitted, [](const P& p) { return p[1] / (2.0 * p[0]); });
  results.mu_s = derived(fitted, [&](const P& p) { return p[3] + fitted.drift; });
  results.mu_k = derived(fitted, [&](const P& p) { return p[4] + fitted.drift; });
  results.delta_mu = derived(fitted, [](const P& p) { return p[3] - p[4]; });
  const model::SharedParameters shared{fitted.value[0], fitted.value[1], fitted.value[2]};
  const double damper =
      shared.gamma * shared.r * fitted.relative_speed / shared.oscillator().omega0_squared();
  const bool never_sticks =
      std::ranges::none_of(estimates.ends, [](SlipEnd end) { return end == SlipEnd::kCaptured; });
  for (Estimate* estimate : {&results.mu_s, &results.delta_mu}) {
    if (!never_sticks) {
      add_systematic(*estimate, UncertaintySource::kDamping, damper);
      continue;
    }
    add_systematic(*estimate,
                   {{UncertaintySource::kDamping, damper},
                    {UncertaintySource::kCreep, of_creep(fitted.value[3] - fitted.value[4],
                                                         shared.r * fitted.relative_speed / shared.omega)}});
  }

  const double n = fitted.amplitude.count;
  results.amplitude = n > 1.0 && !estimates.uniform
                          ? Estimate::of(fitted.amplitude.mean, fitted.amplitude.error_of_mean())
                          : derived(fitted, [](const P& p) {
                              return half_range({p[4], p[3] - p[4], p[2], oscillator_of(p)});
                            });
  results.delta_mu_scatter = n >= 3.0 ? Estimate::of(std::sqrt(fitted.D.variance()),
                                                     std::sqrt(fitted.D.variance() / (2.0 * (n - 1.0))))
                                      : Estimate::none("fewer than three slips to compare");

  results.slip_speed_ratio_threshold =
      estimates.belt.has_one_speed()
          ? derived(fitted, [](const P& p) { return model::slip_speed_ratio_threshold(p[1] / (2.0 * p[0])); })
          : Estimate::none(std::string{kSpeedChanges});
  const double delta_mu = fitted.value[3] - fitted.value[4];
  if (!(delta_mu > 0.0)) {
    results.Q = results.Q_threshold = results.threshold_speed =
        Estimate::none(fmt::format("S - K = {:.4g} is not positive", delta_mu));
    return;
  }
  results.Q =
      estimates.belt.has_one_speed()
          ? derived(fitted, [](const P& p) { return model::dimensionless_speed(p[2], p[0], p[3] - p[4]); })
          : Estimate::none(std::string{kSpeedChanges});
  if (!(shared.gamma > 0.0)) {
    results.Q_threshold = results.threshold_speed =
        Estimate::none(fmt::format("the damping found, {:.3g}, is not positive", shared.gamma));
    return;
  }
  results.Q_threshold =
      derived(fitted, [](const P& p) { return model::Q_threshold(std::abs(p[1]) / (2.0 * p[0])); });
  results.threshold_speed = derived(fitted, [&](const P& p) {
    return model::threshold_speed_m_per_s(model::Oscillator::from_omega(p[0], std::abs(p[1]) / (2.0 * p[0])),
                                          p[3] - p[4], tester.gravity_m_per_s2);
  });
}

std::vector<detect::Cycle> cycle_table(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                       const SlipEstimates& estimates) {
  const estimate::SlipFit& fit = estimates.fit;
  std::vector<detect::Cycle> cycles;
  double last_capture_s = base::kNaN;
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const detect::Fall& slip = slips[i];
    const bool held = i > 0 && is_held_between(trace, slips[i - 1], slip);
    detect::Cycle cycle;
    cycle.number = static_cast<std::int64_t>(i);
    cycle.peak_time_s = estimate::time_at(trace, slip.peak_at);
    if (held) {
      const double cycle_s = i > 1 ? cycles[i - 1].peak_time_s - cycles[i - 2].peak_time_s : 0.0;
      const double trough_s = estimate::time_at(trace, trough_at(trace, slips[i - 1], fit.shared));
      last_capture_s = rests_from_s(trace, slip, trough_s, cycle_s);
    }
    const bool has_next =
        i + 1 < slips.size() && !estimate::is_broken(trace, slip.peak_at, slips[i + 1].peak_at);
    cycle.period_s =
        has_next ? estimate::time_at(trace, slips[i + 1].peak_at) - cycle.peak_time_s : base::kNaN;
    cycle.peak = slip.peak;
    cycle.trough = slip.trough;
    cycle.force_drop = slip.drop();
    cycle.onset_time_s = cycle.capture_time_s = cycle.stick_time_s = cycle.slip_time_s = base::kNaN;
    cycle.delta_mu = cycle.delta_mu_standard_error = cycle.slip_speed_ratio = base::kNaN;
    cycle.pull_speed_m_per_s = base::kNaN;
    if (i == 0 || held) cycle.flags |= detect::kCycleIsFirst;
    const bool captured = estimates.ends[i] == SlipEnd::kCaptured;
    if (captured) cycle.flags |= detect::kCycleCaptured;
    const bool begins_from_stick = i == 0 || estimates.window_of_slip[i] != estimates.window_of_slip[i - 1];
    if (fit.converged && begins_from_stick && estimates.has_window(i)) {
      const estimate::SlipWindow& window = estimates.windows[estimates.window_of_slip[i]];
      const model::SlipModel model{fit.shared, window.slip, captured, estimates.belt};
      cycle.onset_time_s = window.slip.onset_s;
      if (!estimates.belt.is_constant()) {
        cycle.pull_speed_m_per_s =
            estimates.belt.plan().speed_m_per_s(window.slip.onset_s - estimates.belt.start_s());
      }
      cycle.stick_time_s = window.slip.onset_s - last_capture_s;
      cycle.delta_mu = estimates.static_coefficient(window) - window.slip.K;
      cycle.delta_mu_standard_error = fit.delta_mu_error(window);
      // [18], from the fitted waveform: difference quotients of scans read several per cent low.
      cycle.slip_speed_ratio =
          -model.waveform().rate(model.waveform().fastest_slip_time_s()) / model.waveform().r;
      if (captured) {
        cycle.slip_time_s = model.capture_s();
        cycle.capture_time_s = window.slip.onset_s + model.capture_s();
      }
    }
    last_capture_s = cycle.capture_time_s;
    cycles.push_back(cycle);
  }
  return cycles;
}

}  // namespace stickslip::analysis
