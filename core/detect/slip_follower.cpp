#include "core/detect/slip_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/nan.hpp"
#include "core/detect/regime_rule.hpp"
#include "core/detect/slip_rule.hpp"
#include "core/detect/turning_points.hpp"
#include "core/model/capture.hpp"

namespace stickslip::detect {
namespace {

/// Times of the evaluations, in periods after the peak. The first is at kFirstTested, when the rise of c′ of
/// a free oscillation is nearly over (t₃ is at most three quarters of a period after the peak). If captures
/// took longer so far, it is kEarlier before their usual time, but at kLastFirstTested at the latest, when a
/// free oscillation is back at its peak. At kMostPeriods the decision is made with the available evidence.
constexpr double kFirstTested = 0.6;
constexpr double kEarlier = 2.0 / 32.0;
constexpr double kLastFirstTested = 1.0;
constexpr double kMostPeriods = 2.5;
/// Part of the time from the onset to the peak whose scans are used; the onset is only estimated.
constexpr double kSurelySlipping = 0.6;
/// Number of blocks from peak to trough of a slip under way.
constexpr double kBlocksPerFall = 16.0;
/// Reach of the parabola through a turning point: a sixteenth of a period, where the trajectory differs from
/// its parabola by (π/8)⁴/24 = 0.1 % of the amplitude; at least the scan on each side.
constexpr double kReachPerPeriod = 1.0 / 16.0;
constexpr double kLeastReachScans = 1.6;
/// Relative standard deviations of ω from turning points and of r from the slope of a rise; only their ratio
/// to those of the prior matters.
constexpr double kTurningPointSpread = 0.02;
constexpr double kSlopeSpread = 0.05;
/// Number of slips from which on a single deviating rise does not replace the stick rate.
constexpr double kKnownSlips = 2.0;
/// Duration of a rise, relative to that of the fall, above which the middle of the rise is stick.
constexpr double kMostlyStick = 3.0;
/// Memory of the typical S − K, in slips.
constexpr double kTypicalMemory = 16.0;
/// Smallest typical S − K, relative to the height of the peak above K.
constexpr double kLeastTypical = 0.1;

/// Error of a drop by peaks between scans, relative to the drop.
constexpr double kPeakError = 0.02;

/// \return whether a drop exceeds the one that a free oscillation would have by more than noise and sampling
/// explain, so that the sled has stuck in between.
bool is_more_than(double drop, double freely, double sigma) noexcept {
  // Noise of both ends as far as it makes no turning point.
  const double noise = std::numbers::sqrt2 * SlipRule::kHysteresisSigmas * sigma;
  return drop > freely + noise + kPeakError * drop;
}

/// Approximate S − K of a slip from the height of its peak above K, by the undamped (2).
double rough_delta_mu(double peak_above_K, const model::SharedParameters& shared) noexcept {
  const double belt = shared.r / shared.omega;
  const double square = peak_above_K * peak_above_K - belt * belt;
  return std::max(std::sqrt(std::max(square, 0.0)), kLeastTypical * peak_above_K);
}

}  // namespace

double SlipFollower::period_s() const noexcept { return 2.0 * std::numbers::pi / now_.shared.omega; }

void SlipFollower::falls(double peak_s, double lowest_s) noexcept {
  const double half_s = std::max(lowest_s - peak_s, scan_s_);
  // From the onset, a quarter of an oscillation before the peak at most, to where it is caught again.
  buffer_.keep_fine(peak_s - half_s, peak_s + 2.0 * half_s, half_s / kBlocksPerFall);
}

void SlipFollower::gap(double now_s) noexcept {
  buffer_.clear();
  gap_s_ = now_s + scan_s_;
  now_.whole = false;
  if (now_.rise_slope == 0.0) now_.rise_slope = base::kNaN;
  if (!now_.decided) on(Event::kScansEnd);
}

double SlipFollower::freely_next_drop() const noexcept {
  return now_.fall.drop() * std::exp(-2.0 * std::numbers::pi * now_.shared.oscillator().gamma_over_2omega());
}

void SlipFollower::open(const Fall& fall, double peak_s, double trough_s, bool begins_from_stick,
                        double sigma) noexcept {
  // A free oscillation only shrinks: what falls by more than that was stuck in between, and the belt has
  // another speed than was thought.
  const bool contradicted = !begins_from_stick && is_more_than(fall.drop(), freely_next_drop(), sigma);
  if (contradicted) begins_from_stick = true;
  ++slip_number_;
  now_ = {};
  now_.begins_from_stick = begins_from_stick;
  now_.whole = !(peak_s <= gap_s_);
  now_.fall = fall;
  now_.peak_s = peak_s;
  now_.trough_s = trough_s;
  if (!begins_from_stick) last_capture_s_ = base::kNaN;

  const double half_s = std::max(trough_s - peak_s, scan_s_);
  if (begins_from_stick && std::isnan(last_capture_s_)) {
    // Nothing says where the stick began.
    window_from_s_ = rise().line_from_s(buffer_.points(), window_from_s_);
  }
  if (!started_whole_) knowledge_.start(std::numbers::pi / half_s, rise_slope(sigma));
  started_whole_ = started_whole_ || now_.whole;
  if (contradicted) knowledge_.forget_stick_rate(rise_slope(sigma));
  now_.shared = knowledge_.best();

  if (!(usual_.delta_mu > 0.0)) usual_.delta_mu = rough_delta_mu(0.5 * fall.drop(), now_.shared);
  slip_ = {};
  Cycle& cycle = slip_.cycle;
  cycle.peak_time_s = peak_s;
  cycle.peak = fall.peak;
  cycle.trough = fall.trough;
  cycle.force_drop = fall.drop();
  for (double* unknown :
       {&cycle.onset_time_s, &cycle.capture_time_s, &cycle.period_s, &cycle.stick_time_s, &cycle.slip_time_s,
        &cycle.delta_mu, &cycle.delta_mu_standard_error, &cycle.slip_speed_ratio}) {
    *unknown = base::kNaN;
  }
  on(Event::kClosed);
  const bool is_unknown = tier_ == EstimatorTier::kFit && begins_from_stick && !knowledge_.characterised();
  on(is_unknown ? Event::kOpenedUnknown : Event::kOpened);
  if (!is_unknown) schedule_first_test();
}

void SlipFollower::on(Event event) noexcept {
  const auto found = std::ranges::find_if(
      kTransitions, [&](const Transition& at) { return at.state == state_ && at.event == event; });
  if (event == Event::kClosed) {
    state_ = State::kClosed;
  } else if (found != kTransitions.end()) {
    state_ = found->next;
  }
}

Rise SlipFollower::rise() const noexcept {
  return {now_.fall.rise_from, now_.fall.peak, now_.peak_s - std::max(now_.fall.rise_duration, 1.0) * scan_s_,
          now_.peak_s};
}

double SlipFollower::rise_slope(double sigma) noexcept {
  if (now_.rise_slope == 0.0) {
    now_.rise_slope = rise().slope(buffer_.points(), window_from_s_, sigma);
  }
  return now_.rise_slope;
}

bool SlipFollower::do_task(double now_s, double sigma) noexcept {
  switch (state_) {
    case State::kFirstFit:
      first_fit(sigma);
      on(Event::kFirstFitted);
      schedule_first_test();
      return false;
    case State::kTesting:
      return judge(now_s, sigma, !(now_s < now_.peak_s + kMostPeriods * period_s()));
    case State::kFitting:
      estimate(now_s, sigma);
      on(Event::kEstimated);
      return false;
    case State::kClosed:
    case State::kDone:
      break;
  }
  return false;
}

bool SlipFollower::force(double now_s, double sigma, bool has_next) noexcept {
  if (!is_open()) return false;
  const bool was_decided = now_.decided;
  on(Event::kFirstFitted);
  if (state_ == State::kTesting) (void)judge(now_s, sigma, has_next);
  if (state_ == State::kFitting || (!now_.decided && now_.begins_from_stick && !now_.estimated)) {
    estimate(now_s, sigma);
  }
  on(Event::kScansEnd);
  return now_.decided && !was_decided;
}

void SlipFollower::first_fit(double sigma) noexcept {
  // Up to the trough, before which a capture cannot come.
  const estimate::CycleFit fit =
      estimate::fit_cycle(estimate::between(buffer_.points(), window_from_s_, now_.trough_s), false,
                          first_guess(), knowledge_.best(), knowledge_, sigma);
  if (fit.converged) {
    now_.shared = fit.shared;
    now_.first_fit = fit.slip;
  }
  now_.test_from_s = base::kNaN;
}

double SlipFollower::slipping_before_peak_s() const noexcept {
  if (!now_.begins_from_stick) return 0.0;
  return kSurelySlipping * std::clamp(now_.peak_s - first_guess().onset_s, 0.0, 0.25 * period_s());
}

void SlipFollower::schedule_first_test() noexcept {
  const double period = period_s();
  const double usual_s = std::min(usual_.wait_s - kEarlier * period, kLastFirstTested * period);
  now_.next_task_s = now_.peak_s + std::max(kFirstTested * period, usual_s);
}

bool SlipFollower::judge(double now_s, double sigma, bool last) noexcept {
  test_capture(sigma, last ? 0.0 : kDecisive);
  slip_.evidence = now_.evidence.known ? now_.evidence.log_likelihood_ratio : base::kNaN;
  // What neither trajectory describes may be neither: an escape then takes more to be believed.
  const double doubt = std::max(now_.evidence.residual_sigmas / kMisfitSigmas, 1.0);
  const bool clear = now_.evidence.known && (now_.evidence.log_likelihood_ratio > kDecisive ||
                                             now_.evidence.log_likelihood_ratio < -doubt * doubt * kDecisive);
  if (!clear && !last) {
    schedule_next_test(now_s);
    return false;
  }
  on(now_.begins_from_stick ? Event::kTold : Event::kToldOfFree);
  // At the next slip the sign decides; a sled that sticks goes on sticking as long as the scans tell nothing.
  if (!now_.evidence.known) return false;
  const double told = std::log(kDecisiveLikelihoodRatio);
  if (!(now_.evidence.log_likelihood_ratio > 0.0) && !(now_.evidence.log_likelihood_ratio <= -told))
    return false;  // NaN, too.
  decide(now_.evidence.log_likelihood_ratio, now_s);
  if (std::abs(std::log(now_.shared.r / knowledge_.best().r)) > kStickRateChange &&
      now_.shared.r == now_.rise_slope)
    knowledge_.forget_stick_rate(now_.rise_slope);
  if (!captured()) return true;
  usual_.wait_count = std::min(usual_.wait_count + 1.0, kTypicalMemory);
  usual_.wait_s += (now_s - now_.peak_s - usual_.wait_s) / usual_.wait_count;
  if (!now_.begins_from_stick)
    slip_.cycle.capture_time_s = last_capture_s_ = window_from_s_ = now_.evidence.capture_s;
  return true;
}

void SlipFollower::test_capture(double sigma, double decisive) noexcept {
  if (std::isnan(now_.test_from_s)) now_.test_from_s = now_.peak_s - slipping_before_peak_s();
  const auto points = buffer_.since(now_.test_from_s);
  CapturePrior prior{now_.shared, sigma, usual_.delta_mu};
  now_.evidence = capture_test_.evaluate(points, prior, {.decisive = decisive});
  if (!now_.evidence.known || !(now_.evidence.residual_sigmas > kMisfitSigmas)) return;
  // Neither trajectory fits: perhaps the belt has another speed now, which the rise before this slip tells.
  prior.shared.r = rise_slope(sigma);
  if (!(std::abs(std::log(prior.shared.r / now_.shared.r)) > kStickRateChange)) return;
  const CaptureEvidence with_other = capture_test_.evaluate(points, prior, {});
  if (!belt_changed(with_other.residual_sigmas, now_.evidence.residual_sigmas)) return;
  now_.evidence = with_other;
  now_.shared = prior.shared;
  now_.first_fit.reset();
  now_.test_from_s = base::kNaN;
}

bool SlipFollower::belt_changed(double residual_sigmas, double before_sigmas) noexcept {
  if (!BeltChange::explains(residual_sigmas, before_sigmas)) return false;
  const bool seen_before = belt_change_.seen(slip_number_, now_.rise_slope);
  return seen_before || usual_.count < kKnownSlips;
}

void SlipFollower::decide(double evidence, double now_s) noexcept {
  now_.decided = true;
  slip_.evidence = evidence;
  slip_.decided_time_s = now_s;
  if (evidence > 0.0) slip_.cycle.flags |= kCycleCaptured;
}

model::SlipParameters SlipFollower::first_guess() const noexcept {
  const model::Oscillator oscillator = now_.shared.oscillator();
  model::SlipParameters guess;
  guess.K = K_of_turning_points(now_.fall.peak, now_.fall.trough, oscillator);
  const double above = now_.fall.peak - guess.K;
  const double D = std::max(slip_of_peak(above, now_.shared.r, oscillator).delta_mu, 0.1 * above);
  guess.S = guess.K + D;
  guess.onset_s = now_.peak_s - model::SlipWaveform{guess.K, D, now_.shared.r, oscillator}.peak_time_s();
  return guess;
}

void SlipFollower::learn_typical(double delta_mu) noexcept {
  if (!(delta_mu > 0.0)) return;
  usual_.count = std::min(usual_.count + 1.0, kTypicalMemory);
  usual_.delta_mu += (delta_mu - usual_.delta_mu) / usual_.count;
}

void SlipFollower::take_course(const model::SlipParameters& slip, double slip_speed_ratio,
                               double capture_s) noexcept {
  Cycle& cycle = slip_.cycle;
  slip_.S = slip.S;
  slip_.K = slip.K;
  cycle.onset_time_s = slip.onset_s;
  cycle.stick_time_s = slip.onset_s - last_capture_s_;
  cycle.delta_mu = slip.S - slip.K;
  cycle.slip_speed_ratio = slip_speed_ratio;
  last_capture_s_ = base::kNaN;
  if (!captured()) return;
  cycle.slip_time_s = capture_s - slip.onset_s;
  cycle.capture_time_s = last_capture_s_ = capture_s;
}

void SlipFollower::estimate(double now_s, double sigma) noexcept {
  now_.estimated = true;
  // Scans up to the middle of the stick belong to this slip, the others to the next.
  double end_s = now_s;
  if (now_.decided && captured()) {
    end_s = 0.5 * (now_.evidence.capture_s +
                   std::min(std::max(now_s, now_.evidence.capture_s), now_.evidence.next_onset_s));
  } else if (!now_.decided) {
    end_s = now_.trough_s;
  }
  if (tier_ == EstimatorTier::kFit) {
    estimate_by_fit(end_s, sigma);
  } else {
    estimate_by_turning_points(sigma);
  }
  window_from_s_ = end_s;
  buffer_.forget_before(std::min(end_s, now_.peak_s + period_s()));
}

void SlipFollower::estimate_by_fit(double end_s, double sigma) noexcept {
  const bool is_captured = now_.decided && captured();
  const auto points = estimate::between(buffer_.points(), window_from_s_, end_s);
  estimate::CycleFit fit =
      now_.first_fit
          ? estimate::fit_cycle(points, is_captured, *now_.first_fit, now_.shared, knowledge_, sigma)
          : estimate::fit_cycle(points, is_captured, first_guess(), knowledge_.best(), knowledge_, sigma);
  if (fit.converged && fit.residual_sigmas > kMisfitSigmas && rise_slope(sigma) > 0.0 &&
      std::abs(std::log(now_.rise_slope / knowledge_.best().r)) > kStickRateChange) {
    estimate::SharedPosterior anew = knowledge_;
    anew.forget_stick_rate(now_.rise_slope);
    const estimate::CycleFit other =
        estimate::fit_cycle(points, is_captured, first_guess(), anew.best(), anew, sigma);
    if (other.converged && belt_changed(other.residual_sigmas, fit.residual_sigmas)) {
      knowledge_ = anew;
      fit = other;
    }
  }
  if (!fit.converged) {
    // The next stick begins where this slip was captured, not where one before it was.
    last_capture_s_ = is_captured ? now_.evidence.capture_s : base::kNaN;
    return;
  }
  const model::SlipWaveform waveform{fit.slip.K, fit.slip.S - fit.slip.K, fit.shared.r,
                                     fit.shared.oscillator()};
  double capture_s = base::kNaN;
  if (is_captured) {
    capture_s =
        fit.slip.onset_s + model::capture_time_s(waveform, fit.shared.r).value_or(waveform.rise_end_time_s());
  }
  take_course(fit.slip, -waveform.rate(waveform.fastest_slip_time_s()) / fit.shared.r, capture_s);
  slip_.cycle.delta_mu_standard_error = std::sqrt(std::max(fit.delta_mu_variance(), 0.0));
  learn_typical(fit.delta_mu());
  if (fit.residual_sigmas < kMisfitSigmas) knowledge_.learn(fit.evidence);
}

void SlipFollower::learn_turning_points(double fall_s, double sigma) noexcept {
  if (!now_.whole) return;
  const bool mostly_stick = now_.fall.rise_duration * scan_s_ > kMostlyStick * fall_s;
  // Beside a characterisation ω of two turning points counts nothing.
  if (knowledge_.characterised() && !mostly_stick) return;
  estimate::SharedEvidence evidence;
  const double omega = std::numbers::pi / fall_s;
  evidence.information(0, 0) = 1.0 / (kTurningPointSpread * omega * kTurningPointSpread * omega);
  if (const double slope = mostly_stick ? rise_slope(sigma) : 0.0; slope > 0.0) {
    evidence.information(2, 2) = 1.0 / (kSlopeSpread * slope * kSlopeSpread * slope);
    evidence.weighted[2] = evidence.information(2, 2) * slope;
  }
  evidence.weighted[0] = evidence.information(0, 0) * omega;
  knowledge_.learn(evidence);
}

void SlipFollower::estimate_by_turning_points(double sigma) noexcept {
  const double reach_s = std::max(kReachPerPeriod * period_s(), kLeastReachScans * scan_s_);
  const TurningPoint peak = parabola_vertex(buffer_.points(), now_.peak_s, reach_s, 1.0)
                                .value_or(TurningPoint{now_.peak_s, now_.fall.peak});
  const TurningPoint trough = parabola_vertex(buffer_.points(), now_.trough_s, reach_s, -1.0)
                                  .value_or(TurningPoint{now_.trough_s, now_.fall.trough});
  slip_.cycle.peak_time_s = peak.time_s;
  slip_.cycle.peak = peak.value;
  slip_.cycle.trough = trough.value;
  slip_.cycle.force_drop = peak.value - trough.value;
  learn_turning_points(std::max(trough.time_s - peak.time_s, scan_s_), sigma);
  const model::SharedParameters& shared = knowledge_.best();
  const model::Oscillator oscillator = shared.oscillator();
  model::SlipParameters slip;
  slip.K = K_of_turning_points(peak.value, trough.value, oscillator);
  const SlipOfPeak found = slip_of_peak(peak.value - slip.K, shared.r, oscillator);
  slip.S = slip.K + found.delta_mu;
  slip.onset_s = peak.time_s - found.peak_time_s;
  take_course(slip, found.slip_speed_ratio, now_.evidence.capture_s);
  learn_typical(found.delta_mu);
}

}  // namespace stickslip::detect
