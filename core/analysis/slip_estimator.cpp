#include "core/analysis/slip_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "core/analysis/slip_guess.hpp"
#include "core/analysis/slip_windows.hpp"
#include "core/detect/capture_test.hpp"
#include "core/estimate/cycle_buffer.hpp"
#include "core/estimate/uniform_stage.hpp"
#include "core/model/tester.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Limit of the rounds; each decides which slips were captured and fits the model with these decisions.
constexpr int kDecisionRounds = 3;
/// Log-likelihood ratio up to which other evidence overrules a capture: 400 to 1.
constexpr double kDoubtful = 6.0;
/// Smallest relative difference of a second guess of the stick rate that is tried.
constexpr double kOtherRate = 0.1;

/// Decides how slips of a test ended.
class SlipEnds {
 public:
  SlipEnds(const estimate::Trace& trace, std::span<const detect::Fall> slips,
           const model::SharedParameters& shared, double sigma)
      : trace_(trace),
        slips_(slips),
        prior_{shared, sigma, typical_delta_mu(trace, slips, shared), std::nullopt, &trace.belt} {}

  /// Log-likelihood ratio of captured over free from the scans up to position end_at; a lower limit where it
  /// is decisive. 0 with too few scans.
  [[nodiscard]] double log_likelihood_ratio(std::size_t slip, double end_at) {
    const std::size_t end = std::min(scan_at(end_at) + 1, trace_.size());
    const double period_s = 2.0 * std::numbers::pi / prior_.shared.omega;
    estimate::read_slip(scans_, trace_, scan_at(slips_[slip].peak_at), end, period_s);
    const model::SlipParameters next = first_guess(trace_, slips_[slip + 1], prior_.shared);
    prior_.next_delta_mu = next.S > next.K ? std::optional{next.S - next.K} : std::nullopt;
    return test_
        .evaluate(scans_.points(), prior_, {.iterations = kCaptureIterations, .enough = detect::kDecisive})
        .log_likelihood_ratio;
  }

 private:
  static constexpr int kCaptureIterations = 40;

  const estimate::Trace& trace_;
  std::span<const detect::Fall> slips_;
  detect::CapturePrior prior_;
  estimate::CycleBuffer scans_;
  detect::CaptureTest test_;
};

/// Whether ends that are told decisively with parameters `a` are told alike with `b`: over the scans of a
/// test, one and a half oscillations and a stick, the trajectories differ so little that a log-likelihood
/// ratio moves by less than half of what is decisive.
bool tell_alike(const estimate::Trace& trace, const model::SharedParameters& a,
                const model::SharedParameters& b, double delta_mu, double sigma) {
  constexpr double kPhase_rad = 3.0 * std::numbers::pi;
  constexpr double kRise = 2.0;  // A stick rises by twice the amplitude.
  const double difference =
      delta_mu * (kPhase_rad * (std::abs(a.omega - b.omega) + 0.5 * std::abs(a.gamma - b.gamma)) / a.omega +
                  kRise * std::abs(a.r - b.r) / a.r);
  // It grows from nothing at the peak: half its mean square is a sixth of that at the end.
  const double scans = kPhase_rad / a.omega * scans_per_s(trace);
  return scans * difference * difference / 6.0 < 0.5 * detect::kDecisive * sigma * sigma;
}

/// Fills the likelihood ratios.
/// \param decisive_stay  Ratios that are decisive already are not computed again.
std::vector<SlipEnd> judge_ends(const estimate::Trace& trace, std::span<const detect::Fall> slips,
                                const model::SharedParameters& shared, double sigma, bool decisive_stay,
                                SlipEstimates& estimates) {
  std::vector<SlipEnd> ends(slips.size(), SlipEnd::kUnknown);
  const std::vector<double> before = std::exchange(estimates.log_likelihood_ratios, {});
  SlipEnds test{trace, slips, shared, sigma};
  const bool cut = pull_ended_in_last_slip(trace, slips, shared);
  for (std::size_t i = 0; i + 1 < slips.size(); ++i) {
    if (pull_of(trace, slips[i]) != pull_of(trace, slips[i + 1]) || follows_a_break(trace, slips, i + 1)) {
      // The belt stopped in between, or a break follows: the end is unknown.
      estimates.log_likelihood_ratios.push_back(0.0);
      continue;
    }
    const bool to_the_peak = cut && i + 2 == slips.size();
    const bool stays = decisive_stay && std::abs(before[i]) > detect::kDecisive;
    double ratio = stays ? before[i]
                         : test.log_likelihood_ratio(i, to_the_peak ? slips[i + 1].peak_at
                                                                    : trough_at(trace, slips[i + 1], shared));
    // The belt may have stopped before that peak.
    if (to_the_peak && std::abs(ratio) < kDoubtful) ratio = 0.0;
    estimates.log_likelihood_ratios.push_back(ratio);
    if (ratio != 0.0) ends[i] = ratio > 0.0 ? SlipEnd::kCaptured : SlipEnd::kFree;
  }
  return ends;
}

/// Standard errors below which S − K counts as zero: then the slip did not begin from sticking.
constexpr double kInsignificant = 3.0;

/// Changes doubtful captures into free ends. Just above the threshold speed a free oscillation looks almost
/// like a short capture: "captured" then fits as well, but gives the next slip S − K ≤ 0. A stick ends at S >
/// K, so such a capture is rejected. If the fit did not converge, all captures with a ratio up to kDoubtful
/// are rejected.
/// \return whether an end was changed.
bool free_the_doubtful(SlipEstimates& estimates) {
  bool changed = false;
  for (std::size_t i = 0; i < estimates.log_likelihood_ratios.size(); ++i) {
    if (estimates.ends[i] != SlipEnd::kCaptured || estimates.log_likelihood_ratios[i] > kDoubtful) continue;
    if (!estimates.has_window(i + 1)) continue;
    const estimate::SlipWindow& next = estimates.windows[estimates.window_of_slip[i + 1]];
    const double error = estimates.fit.delta_mu_error(next);
    if (estimates.fit.converged && next.slip.S - next.slip.K >= kInsignificant * error) continue;
    estimates.ends[i] = SlipEnd::kFree;
    changed = true;
  }
  return changed;
}

/// Increase of the fit's cost, in units of log-likelihood, below which changed slip ends are always accepted.
constexpr double kWorse = 9.0;
/// Increase of the cost that chance explains; three parameters more or less change it by 1.5.
constexpr double kChance = 3.0;
/// Changed ends are rejected only if the increase of the cost is at least this multiple of the sum of the
/// changed slips' |log-likelihood ratios|.
constexpr double kOutweighs = 3.0;
/// Size of the log-likelihood ratio given to a single changed end that the whole fit does not confirm.
constexpr double kUnsure = 0.1;

std::size_t different(const std::vector<SlipEnd>& a, const std::vector<SlipEnd>& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += a[i] != b[i] ? 1U : 0U;
  return count;
}

/// Accepts or rejects changed slip ends by the cost of the whole fit. A missed spike can reverse the decision
/// on a single slip; the fit of all slips is then the better evidence.
/// \param before  converged fit with the old ends.
/// \param after  fit with the new ends. If rejected, it becomes `before`, with likelihood ratios of the
///        changed ends taken from the increase of the cost.
/// \return whether `after` was accepted.
bool weigh_new_ends(const SlipEstimates& before, SlipEstimates& after) {
  // Windows may have grown or shrunk.
  const double expected = before.fit.cost * static_cast<double>(after.fit.scan_count) /
                          static_cast<double>(before.fit.scan_count);
  // A fit that did not converge is at least no worse than where it stopped.
  const double worse =
      after.fit.scan_count > 0 ? after.fit.cost - expected : std::numeric_limits<double>::infinity();
  if (worse < kChance && after.fit.converged) return true;
  const std::size_t count = different(before.ends, after.ends);
  const auto set = [&](double ratio, const std::vector<SlipEnd>& ends) {
    for (std::size_t i = 0; i < after.log_likelihood_ratios.size(); ++i) {
      if (before.ends[i] == after.ends[i]) continue;
      after.log_likelihood_ratios[i] = ends[i] == SlipEnd::kCaptured ? ratio : -ratio;
    }
  };
  double said = 0.0;
  for (std::size_t i = 0; i < after.log_likelihood_ratios.size(); ++i) {
    if (before.ends[i] != after.ends[i]) said += std::abs(after.log_likelihood_ratios[i]);
  }
  // A capture has three parameters more to hide a spike in: the whole must outweigh what the slips say.
  if (worse < kWorse || worse < kOutweighs * said) {
    if (count == 1 && worse < kWorse) set(kUnsure, after.ends);
    return true;
  }
  set(std::isfinite(worse) ? worse / static_cast<double>(count) : kDoubtful, before.ends);
  std::vector<double> ratios = std::move(after.log_likelihood_ratios);
  after = before;
  after.log_likelihood_ratios = std::move(ratios);
  return false;
}

/// Alternates between deciding which slips were captured and fitting the model, from a first guess.
/// \param found  initial ends; if empty they are decided from the guess.
SlipEstimates rounds(const estimate::Trace& trace, std::span<const detect::Fall> slips, double sigma,
                     const estimate::SharedPrior& prior, model::SharedParameters shared,
                     std::vector<SlipEnd> found = {}) {
  SlipEstimates estimates;
  const auto fit = [&] {
    lay_windows(trace, slips, shared, estimates);
    estimates.fit = windows_suffice(trace, estimates.windows)
                        ? estimate::fit_slips(trace, estimates.windows, shared, sigma, prior)
                        : estimate::SlipFit{};
  };
  std::vector<double> weighed;  // The ratios after the latest weighing.
  model::SharedParameters asked_with;
  for (int round = 0; round < kDecisionRounds; ++round) {
    const SlipEstimates before = estimates;
    if (round > 0 || found.empty()) {
      const bool stay = !estimates.log_likelihood_ratios.empty() &&
                        tell_alike(trace, asked_with, shared, typical_delta_mu(trace, slips, shared), sigma);
      found = judge_ends(trace, slips, shared, sigma, stay, estimates);
      if (!stay) asked_with = shared;
    }
    if (round > 0 && found == before.ends) {
      for (std::size_t i = 0; i < weighed.size(); ++i) {
        if (std::abs(weighed[i]) == kUnsure) estimates.log_likelihood_ratios[i] = weighed[i];
      }
      break;
    }
    estimates.ends = found;
    fit();
    if (free_the_doubtful(estimates)) fit();
    if (round > 0 && !weigh_new_ends(before, estimates)) break;
    weighed = estimates.log_likelihood_ratios;
    if (!estimates.fit.converged) break;
    shared = estimates.fit.shared;
  }
  return estimates;
}

/// Whether the fit converged with residuals of at most 1.2 σ; for 500 scans of pure noise they are (1.00 ±
/// 0.03) σ.
bool describes_well(const SlipEstimates& estimates, double sigma) noexcept {
  constexpr double kNoiseOnly = 1.2;
  return estimates.fit.converged && estimates.fit.residual_sigma <= kNoiseOnly * sigma;
}

bool better(const SlipEstimates& a, const SlipEstimates& b) noexcept {
  return a.fit.converged && (!b.fit.converged || a.fit.residual_sigma < b.fit.residual_sigma);
}

/// A better first guess from those slips alone that most surely began from sticking — the likelier half —
/// each up to its trough, where it does not matter yet how it ends. Turning points tell ω to half a per cent,
/// and then slips that differ much can be taken for a free oscillation, which no fit survives.
/// \param tried has the likelihood ratios.
/// \return nothing if this does not converge either.
std::optional<model::SharedParameters> guess_from_sure_slips(const estimate::Trace& trace,
                                                             std::span<const detect::Fall> slips,
                                                             double sigma, const estimate::SharedPrior& prior,
                                                             const SlipEstimates& tried) {
  const model::SharedParameters shared = first_guess(trace, slips);
  std::vector<double> for_captured;
  std::copy_if(tried.log_likelihood_ratios.begin(), tried.log_likelihood_ratios.end(),
               std::back_inserter(for_captured), [](double ratio) { return ratio > 0.0; });
  const double sure = for_captured.empty() ? kDoubtful : std::max(signal::median(for_captured), kDoubtful);
  std::vector<estimate::SlipWindow> windows;
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const bool loading = begins_a_pull(trace, slips, i);
    if (!loading && tried.log_likelihood_ratios[i - 1] < sure) continue;
    estimate::SlipWindow window;
    window.first = loading ? start_of_loading(trace, slips[i], shared) : boundary(slips[i - 1], slips[i]);
    window.end = std::min(
        {scan_at(trough_at(trace, slips[i], shared)) + 1, trace.size(), end_of_pull(trace, slips[i])});
    window.captured = true;
    window.slip = first_guess(trace, slips[i], shared);
    windows.push_back(window);
  }
  if (!windows_suffice(trace, windows)) return std::nullopt;
  const estimate::SlipFit fit = estimate::fit_slips(trace, windows, shared, sigma, prior);
  return fit.converged ? std::optional{fit.shared} : std::nullopt;
}

/// Nothing but the loading and the first slip tells the stick rate of a ring-down, and a rate that is off by
/// a tenth hides a first slip that did stick again.
/// \param free  converged, no slip captured.
/// \param captured the fit with the first one captured.
bool first_stuck_after_all(const SlipEstimates& free, const SlipEstimates& captured, double sigma) {
  if (!captured.fit.converged || captured.windows.size() < 2 || captured.ends[0] != SlipEnd::kCaptured) {
    return false;
  }
  const auto delta_mu = [&](std::size_t i) {
    return captured.windows[i].slip.S - captured.windows[i].slip.K;
  };
  if (!(delta_mu(0) > 0.0 && delta_mu(1) > 0.0)) return false;
  constexpr double kThreeParameters = 1.5;
  const double surprise = std::log(delta_mu(1) / delta_mu(0)) / detect::kDeltaMuLogScatter;
  // Where spikes have been left the residuals are larger than the noise, and so is what chance gains.
  const double residual = std::max(captured.fit.residual_sigma / sigma, 1.0);
  const double gain = free.fit.cost * static_cast<double>(captured.fit.scan_count) /
                          static_cast<double>(free.fit.scan_count) -
                      captured.fit.cost;
  return gain / (residual * residual) - kThreeParameters - 0.5 * surprise * surprise > kWorse;
}

}  // namespace

TesterEstimate SlipEstimates::tester() const {
  if (!uniform) return TesterEstimate::from(fit.shared, fit.shared_covariance);
  return TesterEstimate::from(uniform->parameters.shared, uniform->covariance.bottomRightCorner<3, 3>());
}

double SlipEstimates::static_coefficient(const estimate::SlipWindow& window) const {
  return window.slip.S +
         belt.acceleration_share(fit.shared.r, fit.shared.oscillator().omega0_squared(), window.slip.onset_s);
}

estimate::SharedPrior held_damping(const estimate::Trace& trace,
                                   const base::LongColumn<detect::Fall>& slips) {
  constexpr double kErrorOfOmega = 0.5;     // Of itself: the half periods of falls with pauses are longer.
  constexpr double kErrorOfDamping = 1e-3;  // Small, so that γ does not move.
  const double half_s = signal::median_of(slips.size(), [&](std::size_t i) {
    const detect::Fall slip = slips[i];
    return estimate::time_at(trace, slip.trough_at) - estimate::time_at(trace, slip.peak_at);
  });
  const double omega = std::numbers::pi / half_s;
  estimate::SharedPrior prior;
  prior.coupling = {
      omega, model::kTypicalGammaOver2Omega,
      Eigen::Vector2d{std::pow(kErrorOfOmega * omega, 2), std::pow(kErrorOfDamping, 2)}.asDiagonal()};
  return prior;
}

SlipEstimates estimate_slips(const estimate::Trace& trace, std::span<const detect::Fall> slips, double sigma,
                             const estimate::SharedPrior& prior, bool first_counts) {
  const model::SharedParameters guess = first_guess(trace, slips);
  SlipEstimates estimates = rounds(trace, slips, sigma, prior, guess);
  const auto try_too = [&](const model::SharedParameters& start, std::vector<SlipEnd> ends) {
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
    if (begins_a_pull(trace, slips, i) || follows_a_break(trace, slips, i)) {
      captured[i - 1] = SlipEnd::kUnknown;
    }
  }
  captured.back() = SlipEnd::kUnknown;
  if (!describes_well(estimates, sigma)) try_too(guess, captured);
  // Spikes in the loading may have spoilt its slope; the sticks between the slips have one too.
  model::SharedParameters other_rate = guess;
  other_rate.r = slope_of_sticks(trace, slips);
  if (!describes_well(estimates, sigma) && std::abs(other_rate.r - guess.r) > kOtherRate * guess.r) {
    try_too(other_rate, {});
    if (!describes_well(estimates, sigma)) try_too(other_rate, captured);
  }
  const bool all_free = std::none_of(estimates.ends.begin(), estimates.ends.end(),
                                     [](SlipEnd end) { return end == SlipEnd::kCaptured; });
  if (estimates.fit.converged && all_free && slips.size() > 2) {
    std::vector<SlipEnd> first_captured = estimates.ends;
    first_captured.front() = SlipEnd::kCaptured;
    SlipEstimates other = rounds(trace, slips, sigma, prior, estimates.fit.shared, std::move(first_captured));
    if (first_stuck_after_all(estimates, other, sigma)) estimates = std::move(other);
  }
  estimates.guess = guess;
  estimates.drift = trace.drift;
  estimates.belt = trace.belt;
  estimates.first_counts = first_counts;
  if (estimates.fit.converged && trace.belt.is_constant()) {
    estimates.uniform = estimate::uniform_if_slips_agree(trace, estimates.windows, estimates.fit.shared,
                                                         sigma, prior, first_counts);
  }
  return estimates;
}

}  // namespace stickslip::analysis
