#include "core/friction/slip_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

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
/// Log of the likelihood ratio up to which a capture is not believed against other evidence: 400 to 1.
constexpr double kDoubtful = 6.0;
/// Slips of which the last may be left out because the pull ended in it.
constexpr std::size_t kFewestForEndOfPull = 4;
/// Part of the loading that a motor takes to get to its speed.
constexpr double kRoundedStart = 0.2;
/// Part by which another guess of the stick rate must differ to be worth a try.
constexpr double kOtherRate = 0.1;
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

/// Level from which the force rises to the peak: the median about the turning point, which two spikes there
/// do not move.
double level_before(const Trace& trace, const Fall& fall) {
  constexpr std::size_t kReach = 3;
  const std::size_t turn = scan_at(fall.peak_at - fall.rise_duration);
  std::vector<double> levels;
  for (std::size_t k = turn > kReach ? turn - kReach : 0; k <= turn + kReach && k < trace.size(); ++k) {
    levels.push_back(trace.value[k]);
  }
  return signal::median(levels);
}

/// Slope of the loading from rest: upper quartile of those over an eighth of it, or from scan to scan if it
/// is shorter. It begins less steep, while a sled that a fast start of the belt has left behind catches up,
/// and ends so, where it slips.
double slope_of_loading(const Trace& trace, const Fall& first) {
  constexpr double kFrom = 0.1;
  constexpr double kTo = 0.95;
  constexpr std::size_t kParts = 8;
  const std::size_t peak = std::min(scan_at(first.peak_at), trace.size() - 1);
  const double rest = level_before(trace, first);
  const auto at_least = [&](std::size_t k, double level) {
    return trace.value[k] >= rest + level * (first.peak - rest);
  };
  std::size_t begin = peak;
  while (begin > 0 && at_least(begin - 1, kFrom)) --begin;
  const std::size_t lag = std::max<std::size_t>((peak - begin) / kParts, 1);
  std::vector<double> slopes;
  for (std::size_t k = begin; k + lag <= peak && !at_least(k + lag, kTo); ++k) {
    if (trace.usable[k] == 0 || trace.usable[k + lag] == 0) continue;
    slopes.push_back((trace.value[k + lag] - trace.value[k]) / (trace.time_s[k + lag] - trace.time_s[k]));
  }
  if (slopes.empty()) {
    for (std::size_t k = std::max<std::size_t>(begin, 1); k <= peak; ++k) {
      slopes.push_back((trace.value[k] - trace.value[k - 1]) / (trace.time_s[k] - trace.time_s[k - 1]));
    }
    return *std::max_element(slopes.begin(), slopes.end());
  }
  const auto quartile = slopes.begin() + static_cast<std::ptrdiff_t>(3 * slopes.size() / 4);
  std::nth_element(slopes.begin(), quartile, slopes.end());
  return *quartile;
}

/// Median over the rises to the peaks: half of a rise is stick, where there is any. Where the speed changes,
/// over what each is of the plan's largest.
double slope_of_sticks(const Trace& trace, std::span<const Fall> slips) {
  std::vector<double> slopes;
  for (const Fall& slip : slips) {
    const double slope = slope_of_rise(trace, slip, 0.3, 0.7);
    const double relative =
        trace.belt.is_constant()
            ? 1.0
            : trace.belt.relative(time_at(trace, slip.peak_at - 0.5 * slip.rise_duration));
    if (relative > 0.0) slopes.push_back(slope / relative);
  }
  return slopes.empty() ? slope_of_rise(trace, slips.front(), 0.3, 0.7) : signal::median(slopes);
}

SharedParameters first_guess(const Trace& trace, std::span<const Fall> slips) {
  std::vector<double> half_periods;
  for (const Fall& slip : slips) {
    // Maximum and minimum of a damped oscillation are π/ω apart, whatever γ and the drift.
    half_periods.push_back(time_at(trace, slip.trough_at) - time_at(trace, slip.peak_at));
  }
  SharedParameters shared;
  shared.omega = std::numbers::pi / signal::median(half_periods);
  shared.gamma = 2.0 * kFirstGammaOver2Omega * shared.omega;
  const Fall& first = slips.front();
  const bool from_loading =
      trace.belt.is_constant() && level_before(trace, first) < kLoadingStartsBelow * first.peak;
  shared.r = from_loading ? slope_of_loading(trace, first) : slope_of_sticks(trace, slips);
  return shared;
}

/// Stick rate at the peak of a slip.
double rate_at(const Trace& trace, const Fall& slip, const SharedParameters& shared) {
  return trace.belt.is_constant() ? shared.r : trace.belt.stick_rate(shared.r, time_at(trace, slip.peak_at));
}

/// First guess of one slip's own parameters from its peak and trough.
SlipParameters first_guess(const Trace& trace, const Fall& slip, const SharedParameters& shared) {
  const double amplitude = 0.5 * slip.drop();
  const double belt = rate_at(trace, slip, shared) / shared.omega;
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
double typical_delta_mu(const Trace& trace, std::span<const Fall> slips, const SharedParameters& shared) {
  std::vector<double> D;
  double largest = 0.0;
  for (const Fall& slip : slips) {
    const double belt = rate_at(trace, slip, shared) / shared.omega;
    const double amplitude = 0.5 * slip.drop();
    largest = std::max(largest, amplitude);
    if (amplitude > belt) D.push_back(std::sqrt(amplitude * amplitude - belt * belt));
  }
  return D.empty() ? largest : signal::median(D);
}

std::size_t pull_of(const Trace& trace, const Fall& slip) {
  return trace.belt.is_constant() ? 0 : trace.belt.pull_of(time_at(trace, slip.peak_at));
}

/// The pull ended while the last slip was on its way: what follows its trough does not climb as a stick does.
/// Where the trace ends before that can be seen, it counts as any other.
bool pull_ended_in_last_slip(const Trace& trace, std::span<const Fall> slips,
                             const SharedParameters& shared) {
  constexpr double kClimbs = 0.5;
  if (slips.size() < kFewestForEndOfPull) return false;
  const double period = 2.0 * std::numbers::pi / shared.omega * scans_per_s(trace);
  const double trough = trough_at(trace, slips.back(), shared);
  const std::size_t begin = scan_at(trough + 0.5 * period);
  const std::size_t end = scan_at(trough + 2.5 * period);
  if (end >= trace.size()) return false;
  const double rise = trace.value[end] - trace.value[begin];
  return rise <
         kClimbs * trace.belt.climb(shared.r, trace.time_s[begin], trace.time_s[end] - trace.time_s[begin]);
}

/// Fills the likelihood ratios.
std::vector<SlipEnd> judge_ends(const Trace& trace, std::span<const Fall> slips,
                                const SharedParameters& shared, double sigma, SlipEstimates& estimates) {
  std::vector<SlipEnd> ends(slips.size(), SlipEnd::kUnknown);
  estimates.log_likelihood_ratios.clear();
  const double typical = typical_delta_mu(trace, slips, shared);
  const bool cut = pull_ended_in_last_slip(trace, slips, shared);
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) {
    if (pull_of(trace, slips[i]) != pull_of(trace, slips[i + 1])) {
      // The belt stopped in between: its end is not known.
      estimates.log_likelihood_ratios.push_back(0.0);
      continue;
    }
    const bool to_the_peak = cut && i + 2 == slips.size();
    const double end_at = to_the_peak ? slips[i + 1].peak_at : trough_at(trace, slips[i + 1], shared);
    const std::size_t end = std::min(scan_at(end_at) + 1, trace.size());
    double ratio =
        capture_log_likelihood_ratio(trace, scan_at(slips[i].peak_at), end, shared, sigma, typical);
    // The belt may have stopped before that peak.
    if (to_the_peak && std::abs(ratio) < kDoubtful) ratio = 0.0;
    estimates.log_likelihood_ratios.push_back(ratio);
    if (ratio != 0.0) ends[i] = ratio > 0.0 ? SlipEnd::kCaptured : SlipEnd::kFree;
  }
  return ends;
}

/// S − K that stays below so many of its standard errors is no stick.
constexpr double kInsignificant = 3.0;

/// A slip just above the threshold speed goes on almost as if it had been captured for a moment, at the least
/// possible amplitude: then "captured" fits as well, and needs a next slip with S − K at or below 0. A stick
/// ends at S > K, so such captures are none; nor, where the fit finds no answer, are those that the scans
/// hardly tell. \return whether an end was changed.
bool free_the_doubtful(SlipEstimates& estimates) {
  bool changed = false;
  for (std::size_t i = 0; i < estimates.log_likelihood_ratios.size(); ++i) {
    if (estimates.ends[i] != SlipEnd::kCaptured || estimates.log_likelihood_ratios[i] > kDoubtful) continue;
    if (!estimates.has_window(i + 1)) continue;
    const SlipWindow& next = estimates.windows[estimates.window_of_slip[i + 1]];
    const Eigen::Matrix3d covariance = estimates.fit.covariance(next);
    const double error = std::sqrt(covariance(1, 1) + covariance(2, 2) - 2.0 * covariance(1, 2));
    if (estimates.fit.converged && next.slip.S - next.slip.K >= kInsignificant * error) continue;
    estimates.ends[i] = SlipEnd::kFree;
    changed = true;
  }
  return changed;
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
  const double rest = level_before(trace, first);
  const double K = 0.5 * (first.peak + first.trough) - rest;
  const double rate = rate_at(trace, first, shared);
  const double caught_up = 2.0 * rate * rate / (shared.oscillator().omega0_squared() * K);
  const double range = first.peak - rest;
  const double level = rest + std::clamp(caught_up, kRoundedStart * range, range);
  for (std::size_t k = start; k < peak; ++k) {
    if (trace.value[k] < level) start = k + 1;
  }
  return start;
}

/// The first slip of the test, or after the belt had stopped.
bool begins_a_pull(const Trace& trace, std::span<const Fall> slips, std::size_t i) {
  return i == 0 || pull_of(trace, slips[i - 1]) != pull_of(trace, slips[i]);
}

/// The first scan after the pull in which the slip lies.
std::size_t end_of_pull(const Trace& trace, const Fall& slip) {
  if (trace.belt.is_constant()) return trace.size();
  const double end_s = trace.belt.pull_end_s(pull_of(trace, slip));
  std::size_t end = std::min(scan_at(slip.peak_at), trace.size());
  while (end < trace.size() && trace.time_s[end] < end_s) ++end;
  return end;
}

void lay_windows(const Trace& trace, std::span<const Fall> slips, const SharedParameters& shared,
                 SlipEstimates& estimates) {
  estimates.windows.clear();
  estimates.window_of_slip.clear();
  const double period_s = 2.0 * std::numbers::pi / shared.omega;
  const bool cut = pull_ended_in_last_slip(trace, slips, shared);
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const bool loading = begins_a_pull(trace, slips, i);
    const bool begins = loading || estimates.ends[i - 1] == SlipEnd::kCaptured;
    if (cut && i + 1 == slips.size() && estimates.ends[i - 1] != SlipEnd::kFree) {
      estimates.window_of_slip.push_back(SlipEstimates::kNoWindow);
      break;
    }
    if (begins) {
      SlipWindow window;
      window.first = loading ? start_of_loading(trace, slips[i], shared) : boundary(slips[i - 1], slips[i]);
      window.slip = first_guess(trace, slips[i], shared);
      estimates.windows.push_back(window);
    }
    estimates.window_of_slip.push_back(estimates.windows.size() - 1);
    SlipWindow& window = estimates.windows.back();
    window.captured = estimates.ends[i] != SlipEnd::kFree;
    if (i + 1 < slips.size() && !begins_a_pull(trace, slips, i + 1)) {
      window.end = boundary(slips[i], slips[i + 1]);
    } else {
      // Up to the trough the two courses are the same; a free oscillation has a tail to learn from.
      const bool free_before = !loading && estimates.ends[i - 1] == SlipEnd::kFree;
      window.captured = !free_before;
      const double tail = free_before ? kTailPeriods * period_s * scans_per_s(trace) : 0.0;
      window.end = scan_at(trough_at(trace, slips[i], shared) + tail) + 1;
    }
    window.end = std::min({window.end, trace.size(), end_of_pull(trace, slips[i])});
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

/// Log-likelihood, in units of a cost, by which other ends must be worse before they are refused, and within
/// which one end alone is a matter of chance: three parameters more or less are worth 1.5 by themselves.
constexpr double kWorse = 9.0;
constexpr double kChance = 3.0;
/// Log-likelihood ratio of an end that is a matter of chance.
constexpr double kUnsure = 0.1;

std::size_t different(const std::vector<SlipEnd>& a, const std::vector<SlipEnd>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1U : 0U;
  return count;
}

/// Single slips have turned over the ends that a fit was based on: does the fit of the whole bear them out? A
/// spike that was not found makes a slip look like another; all other slips know better what it was.
/// \param before  the fit, converged. \param after  with the new ends; where it is worse it becomes `before`
/// with what the whole says of the ends in question.
/// \return whether `after` was kept.
bool weigh_new_ends(const SlipEstimates& before, SlipEstimates& after) {
  // Windows may have grown or shrunk.
  const double expected = before.fit.cost * static_cast<double>(after.fit.scan_count) /
                          static_cast<double>(before.fit.scan_count);
  const double worse =
      after.fit.converged ? after.fit.cost - expected : std::numeric_limits<double>::infinity();
  if (worse < kChance) return true;
  const std::size_t count = different(before.ends, after.ends);
  const auto set = [&](double ratio, const std::vector<SlipEnd>& ends) {
    for (std::size_t i = 0; i < after.log_likelihood_ratios.size(); ++i) {
      if (before.ends[i] == after.ends[i]) continue;
      after.log_likelihood_ratios[i] = ends[i] == SlipEnd::kCaptured ? ratio : -ratio;
    }
  };
  if (worse < kWorse) {
    if (count == 1) set(kUnsure, after.ends);
    return true;
  }
  set(std::isfinite(worse) ? worse / static_cast<double>(count) : kDoubtful, before.ends);
  std::vector<double> ratios = std::move(after.log_likelihood_ratios);
  after = before;
  after.log_likelihood_ratios = std::move(ratios);
  return false;
}

/// Rounds of deciding which slips were captured and fitting what follows from it, from a first guess.
/// \param found  ends to begin with; empty: those that the guess says.
SlipEstimates rounds(const Trace& trace, std::span<const Fall> slips, double sigma, const SharedPrior& prior,
                     SharedParameters shared, std::vector<SlipEnd> found = {}) {
  SlipEstimates estimates;
  const auto fit = [&] {
    lay_windows(trace, slips, shared, estimates);
    estimates.fit = windows_suffice(trace, estimates.windows)
                        ? fit_slips(trace, estimates.windows, shared, sigma, prior)
                        : SlipFit{};
  };
  for (int round = 0; round < kRounds; ++round) {
    const SlipEstimates before = estimates;
    if (round > 0 || found.empty()) found = judge_ends(trace, slips, shared, sigma, estimates);
    if (round > 0 && found == before.ends) break;
    estimates.ends = found;
    fit();
    if (free_the_doubtful(estimates)) fit();
    if (round > 0 && !weigh_new_ends(before, estimates)) break;
    if (!estimates.fit.converged) break;
    shared = estimates.fit.shared;
  }
  return estimates;
}

/// The model leaves hardly more than noise. Of 500 scans, that is 1.00 ± 0.03 of it.
bool describes_well(const SlipEstimates& estimates, double sigma) noexcept {
  constexpr double kNoiseOnly = 1.2;
  return estimates.fit.converged && estimates.fit.residual_sigma <= kNoiseOnly * sigma;
}

bool better(const SlipEstimates& a, const SlipEstimates& b) noexcept {
  return a.fit.converged && (!b.fit.converged || a.fit.residual_sigma < b.fit.residual_sigma);
}

/// A better first guess from those slips alone that most surely began from sticking — the likelier half —
/// each up to its trough, where it does not matter yet how it ends. Turning points tell ω to half a per cent,
/// and then slips that differ much can be taken for a free oscillation, which no fit survives. \param tried
/// has the likelihood ratios. \return nothing if this does not converge either.
std::optional<SharedParameters> guess_from_sure_slips(const Trace& trace, std::span<const Fall> slips,
                                                      double sigma, const SharedPrior& prior,
                                                      const SlipEstimates& tried) {
  const SharedParameters shared = first_guess(trace, slips);
  std::vector<double> for_captured;
  std::copy_if(tried.log_likelihood_ratios.begin(), tried.log_likelihood_ratios.end(),
               std::back_inserter(for_captured), [](double ratio) { return ratio > 0.0; });
  const double sure = for_captured.empty() ? kDoubtful : std::max(signal::median(for_captured), kDoubtful);
  std::vector<SlipWindow> windows;
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const bool loading = begins_a_pull(trace, slips, i);
    if (!loading && tried.log_likelihood_ratios[i - 1] < sure) continue;
    SlipWindow window;
    window.first = loading ? start_of_loading(trace, slips[i], shared) : boundary(slips[i - 1], slips[i]);
    window.end = std::min(
        {scan_at(trough_at(trace, slips[i], shared)) + 1, trace.size(), end_of_pull(trace, slips[i])});
    window.captured = true;
    window.slip = first_guess(trace, slips[i], shared);
    windows.push_back(window);
  }
  if (!windows_suffice(trace, windows)) return std::nullopt;
  const SlipFit fit = fit_slips(trace, windows, shared, sigma, prior);
  return fit.converged ? std::optional{fit.shared} : std::nullopt;
}

}  // namespace

double time_at(const Trace& trace, double position) noexcept {
  const auto before =
      static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(trace.size() - 1)));
  const std::size_t after = std::min(before + 1, trace.size() - 1);
  return trace.time_s[before] +
         (position - static_cast<double>(before)) * (trace.time_s[after] - trace.time_s[before]);
}

TesterEstimate SlipEstimates::tester() const {
  if (!uniform) return TesterEstimate::from(fit.shared, fit.shared_covariance);
  return TesterEstimate::from(uniform->parameters.shared, uniform->covariance.bottomRightCorner<3, 3>());
}

double SlipEstimates::static_coefficient(const SlipWindow& window) const {
  return window.slip.S +
         belt.acceleration_share(fit.shared.r, fit.shared.oscillator().omega0_squared(), window.slip.onset_s);
}

SlipEstimates estimate_slips(const Trace& trace, std::span<const Fall> slips, double sigma,
                             const SharedPrior& prior) {
  const SharedParameters guess = first_guess(trace, slips);
  SlipEstimates estimates = rounds(trace, slips, sigma, prior, guess);
  const auto try_too = [&](const SharedParameters& start, std::vector<SlipEnd> ends) {
    SlipEstimates other = rounds(trace, slips, sigma, prior, start, std::move(ends));
    if (better(other, estimates)) estimates = std::move(other);
  };
  if (!estimates.fit.converged) {
    const auto surer = guess_from_sure_slips(trace, slips, sigma, prior, estimates);
    if (surer) try_too(*surer, {});
  }
  // A rough first guess may call stick-slip near the threshold an oscillation without damping, which fits
  // not too badly: then begin from the other end, as if each slip had been captured.
  std::vector<SlipEnd> captured(slips.size(), SlipEnd::kCaptured);
  for (std::size_t i = 1; i < slips.size(); ++i) {
    if (begins_a_pull(trace, slips, i)) captured[i - 1] = SlipEnd::kUnknown;
  }
  captured.back() = SlipEnd::kUnknown;
  if (!describes_well(estimates, sigma)) try_too(guess, captured);
  // Spikes in the loading may have spoilt its slope; the sticks between the slips have one too.
  SharedParameters other_rate = guess;
  other_rate.r = slope_of_sticks(trace, slips);
  if (!describes_well(estimates, sigma) && std::abs(other_rate.r - guess.r) > kOtherRate * guess.r) {
    try_too(other_rate, {});
    if (!describes_well(estimates, sigma)) try_too(other_rate, captured);
  }
  estimates.drift = trace.drift;
  estimates.belt = trace.belt;
  if (estimates.fit.converged && trace.belt.is_constant()) {
    estimates.uniform = uniform_if_slips_agree(trace, estimates.windows, estimates.fit.shared, sigma, prior);
  }
  return estimates;
}

}  // namespace stickslip::friction
