#include "core/friction/slip_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/friction/junction.hpp"
#include "core/friction/uniform_stage.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::friction {
namespace {

/// First guess of γ/2ω: the paper's tester, (19).
constexpr double kFirstGammaOver2Omega = 0.022;
/// Rounds of deciding which slips were captured and fitting what follows from it.
constexpr int kRounds = 3;
/// A rise that starts below this part of its peak is the loading of a test from rest.
constexpr double kLoadingStartsBelow = 0.5;
/// Part of the loading that a motor takes to get to its speed.
constexpr double kRoundedStart = 0.2;
/// A window of a free oscillation ends this many periods after the trough of its last slip: by
/// then the amplitude is below what makes a slip significant.
constexpr double kTailPeriods = 1.5;

std::size_t scan_at(double position) {
  return static_cast<std::size_t>(std::lround(std::max(position, 0.0)));
}

/// Least-squares slope of the rise to `peak` from the turning point before, between levels `low`
/// and `high` (parts of the rise): there the sled sticks and the force rises at the rate r.
double slope_of_rise(const Trace& trace, const Fall& fall, double low, double high) {
  const std::size_t peak = std::min(scan_at(fall.peak_at), trace.size() - 1);
  const std::size_t length = std::min(static_cast<std::size_t>(fall.rise_duration), peak);
  const double range = fall.peak - fall.rise_from;
  double n = 0.0;
  double mean_t = 0.0;
  double mean_c = 0.0;
  double s_tt = 0.0;
  double s_tc = 0.0;
  for (std::size_t k = peak - length; k <= peak; ++k) {
    const double level = (trace.value[k] - fall.rise_from) / range;
    if (trace.usable[k] == 0 || level < low || level > high) continue;
    // Running means: no difference of large sums [Welford, Technometrics 4(3):419–420, 1962].
    n += 1.0;
    const double dt = trace.time_s[k] - mean_t;
    mean_t += dt / n;
    mean_c += (trace.value[k] - mean_c) / n;
    s_tt += dt * (trace.time_s[k] - mean_t);
    s_tc += dt * (trace.value[k] - mean_c);
  }
  if (n >= 2.0 && s_tt > 0.0) return s_tc / s_tt;
  return length > 0 ? range / (trace.time_s[peak] - trace.time_s[peak - length]) : 0.0;
}

/// Steepest part of the loading from rest. It begins less steep, while a sled that a fast start of the belt
/// has left behind catches up, and ends so, where it slips.
double slope_of_loading(const Trace& trace, const Fall& first) {
  double steepest = 0.0;
  for (const double low : {0.2, 0.3, 0.4, 0.5}) {
    steepest = std::max(steepest, slope_of_rise(trace, first, low, low + 0.2));
  }
  return steepest;
}

SharedParameters first_guess(const Trace& trace, std::span<const Fall> slips) {
  std::vector<double> half_periods;
  std::vector<double> slopes;
  for (const Fall& slip : slips) {
    // Maximum and minimum of a damped oscillation are π/ω apart, whatever γ and the drift.
    half_periods.push_back(time_at(trace, slip.trough_at) - time_at(trace, slip.peak_at));
    slopes.push_back(slope_of_rise(trace, slip, 0.3, 0.7));
  }
  SharedParameters shared;
  shared.omega = std::numbers::pi / signal::median(half_periods);
  shared.gamma = 2.0 * kFirstGammaOver2Omega * shared.omega;
  const Fall& first = slips.front();
  const bool loaded_from_rest = first.rise_from < kLoadingStartsBelow * first.peak;
  shared.r = loaded_from_rest ? slope_of_loading(trace, first) : signal::median(slopes);
  return shared;
}

/// First guess of one slip's own parameters from its peak and trough.
SlipParameters first_guess(const Trace& trace, const Fall& slip, const SharedParameters& shared) {
  const double amplitude = 0.5 * slip.drop();
  const double belt = shared.r / shared.omega;
  // [2] without damping: amplitude² = D² + (r/ω)².
  const double D = std::sqrt(std::max(amplitude * amplitude - belt * belt, 0.01 * amplitude * amplitude));
  SlipParameters parameters;
  parameters.K = 0.5 * (slip.peak + slip.trough) - trace.drift.at(time_at(trace, slip.peak_at));
  parameters.S = parameters.K + D;
  parameters.onset_s = time_at(trace, slip.peak_at) - std::atan2(belt, D) / shared.omega;
  return parameters;
}

double scans_per_s(const Trace& trace) {
  return static_cast<double>(trace.size() - 1) / (trace.time_s.back() - trace.time_s.front());
}

/// Where a slip is at its lowest, in scans: half an oscillation after its peak. What follows may be flat (a
/// belt that stops), and its lowest scan anywhere.
double trough_at(const Trace& trace, const Fall& slip, const SharedParameters& shared) {
  constexpr double kMargin = 1.15;  // For the first guess of ω.
  return std::min(slip.trough_at,
                  slip.peak_at + kMargin * std::numbers::pi / shared.omega * scans_per_s(trace));
}

/// S − K of a slip by its amplitude, [2]: median of those that moved faster than the belt.
double typical_delta_mu(std::span<const Fall> slips, const SharedParameters& shared) {
  const double belt = shared.r / shared.omega;
  std::vector<double> D;
  double largest = 0.0;
  for (const Fall& slip : slips) {
    const double amplitude = 0.5 * slip.drop();
    largest = std::max(largest, amplitude);
    if (amplitude > belt) D.push_back(std::sqrt(amplitude * amplitude - belt * belt));
  }
  return D.empty() ? largest : signal::median(D);
}

void judge_ends(const Trace& trace, std::span<const Fall> slips, const SharedParameters& shared, double sigma,
                SlipEstimates& estimates) {
  estimates.ends.assign(slips.size(), SlipEnd::kUnknown);
  estimates.log_likelihood_ratios.clear();
  const double typical = typical_delta_mu(slips, shared);
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) {
    const std::size_t end = std::min(scan_at(trough_at(trace, slips[i + 1], shared)) + 1, trace.size());
    const double ratio =
        capture_log_likelihood_ratio(trace, scan_at(slips[i].peak_at), end, shared, sigma, typical);
    estimates.log_likelihood_ratios.push_back(ratio);
    estimates.ends[i] = ratio > 0.0 ? SlipEnd::kCaptured : SlipEnd::kFree;
  }
}

/// Half way along the rise between two slips: scans before it belong to the first, after it to the second.
std::size_t boundary(const Fall& before, const Fall& after) {
  return scan_at(0.5 * (before.trough_at + after.peak_at));
}

/// Where the first slip's window begins: above the rounded start of the loading. A sled that the belt's start
/// has left behind has caught up after v/(K g) at c = r²/(ω₀² K); twice that is taken.
std::size_t start_of_loading(const Trace& trace, const Fall& first, const SharedParameters& shared) {
  const std::size_t peak = scan_at(first.peak_at);
  std::size_t start = peak - std::min(static_cast<std::size_t>(first.rise_duration), peak);
  const double K = 0.5 * (first.peak + first.trough) - first.rise_from;
  const double caught_up = 2.0 * shared.r * shared.r / (shared.oscillator().omega0_squared() * K);
  const double range = first.peak - first.rise_from;
  const double level = first.rise_from + std::clamp(caught_up, kRoundedStart * range, range);
  for (std::size_t k = start; k < peak; ++k) {
    if (trace.value[k] < level) start = k + 1;
  }
  return start;
}

void lay_windows(const Trace& trace, std::span<const Fall> slips, const SharedParameters& shared,
                 SlipEstimates& estimates) {
  estimates.windows.clear();
  estimates.window_of_slip.clear();
  const double period_s = 2.0 * std::numbers::pi / shared.omega;
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const bool begins = i == 0 || estimates.ends[i - 1] == SlipEnd::kCaptured;
    if (begins) {
      SlipWindow window;
      window.first = i == 0 ? start_of_loading(trace, slips[0], shared) : boundary(slips[i - 1], slips[i]);
      window.slip = first_guess(trace, slips[i], shared);
      estimates.windows.push_back(window);
    }
    estimates.window_of_slip.push_back(estimates.windows.size() - 1);
    SlipWindow& window = estimates.windows.back();
    window.captured = estimates.ends[i] != SlipEnd::kFree;
    if (i + 1 < slips.size()) {
      window.end = boundary(slips[i], slips[i + 1]);
    } else {
      // Up to the trough the two courses are the same; a free oscillation has a tail to learn from.
      const bool free_before = i > 0 && estimates.ends[i - 1] == SlipEnd::kFree;
      window.captured = !free_before;
      const double tail = free_before ? kTailPeriods * period_s * scans_per_s(trace) : 0.0;
      window.end = scan_at(trough_at(trace, slips[i], shared) + tail) + 1;
    }
    window.end = std::min(window.end, trace.size());
  }
}

/// Each slip has scans enough for its own parameters and one to spare.
bool windows_suffice(const Trace& trace, const std::vector<SlipWindow>& windows) {
  constexpr std::ptrdiff_t kFewestScans = 4;
  return std::all_of(windows.begin(), windows.end(), [&](const SlipWindow& window) {
    if (window.first >= window.end) return false;
    const auto first = trace.usable.begin() + static_cast<std::ptrdiff_t>(window.first);
    const auto end = trace.usable.begin() + static_cast<std::ptrdiff_t>(window.end);
    return std::count(first, end, 1) >= kFewestScans;
  });
}

/// Fits what follows from the ends of the slips, judges the ends anew, and so on until they stay.
void fit_and_judge(const Trace& trace, std::span<const Fall> slips, SharedParameters shared, double sigma,
                   const SharedPrior& prior, SlipEstimates& estimates) {
  for (int round = 0; round < kRounds; ++round) {
    lay_windows(trace, slips, shared, estimates);
    if (!windows_suffice(trace, estimates.windows)) {
      estimates.fit = {};
      return;
    }
    estimates.fit = fit_slips(trace, estimates.windows, shared, sigma, prior);
    if (!estimates.fit.converged) return;
    shared = estimates.fit.shared;
    const std::vector<SlipEnd> before = estimates.ends;
    judge_ends(trace, slips, shared, sigma, estimates);
    if (estimates.ends == before) return;
  }
}

/// The model leaves hardly more than noise. Of 500 scans, that is 1.00 ± 0.03 of it.
bool describes_well(const SlipEstimates& estimates, double sigma) noexcept {
  constexpr double kNoiseOnly = 1.2;
  return estimates.fit.converged && estimates.fit.residual_sigma <= kNoiseOnly * sigma;
}

bool better(const SlipEstimates& a, const SlipEstimates& b) noexcept {
  return a.fit.converged && (!b.fit.converged || a.fit.residual_sigma < b.fit.residual_sigma);
}

}  // namespace

double time_at(const Trace& trace, double position) noexcept {
  const auto before =
      static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(trace.size() - 1)));
  const std::size_t after = std::min(before + 1, trace.size() - 1);
  return trace.time_s[before] +
         (position - static_cast<double>(before)) * (trace.time_s[after] - trace.time_s[before]);
}

SlipEstimates estimate_slips(const Trace& trace, std::span<const Fall> slips, double sigma,
                             const SharedPrior& prior) {
  const SharedParameters guess = first_guess(trace, slips);
  SlipEstimates estimates;
  judge_ends(trace, slips, guess, sigma, estimates);
  fit_and_judge(trace, slips, guess, sigma, prior, estimates);
  if (!describes_well(estimates, sigma)) {
    // A rough first guess may call stick-slip near the threshold an oscillation without damping, which fits
    // not too badly: then begin from the other end, as if each slip had been captured.
    SlipEstimates other;
    other.ends.assign(slips.size(), SlipEnd::kCaptured);
    other.ends.back() = SlipEnd::kUnknown;
    other.log_likelihood_ratios.assign(slips.size() - 1, 0.0);
    fit_and_judge(trace, slips, guess, sigma, prior, other);
    if (better(other, estimates)) estimates = std::move(other);
  }
  estimates.drift = trace.drift;
  if (estimates.fit.converged) {
    estimates.uniform = uniform_if_slips_agree(trace, estimates.windows, estimates.fit.shared, sigma, prior);
  }
  return estimates;
}

}  // namespace stickslip::friction
