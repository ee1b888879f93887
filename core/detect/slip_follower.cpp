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

/// ln 10⁴: then one wrong end in ten thousand slips at most [Wald, Ann. Math. Stat. 16:117–186, 1945,
/// (3:42)].
constexpr double kDecisive = 9.210340371976184;
/// Times of the evaluations, in periods after the peak. The first is at kFirstAsked, when the rise of c′ of a
/// free oscillation is nearly over (t₃ is at most three quarters of a period after the peak). If captures
/// took longer so far, it is kEarlier before their usual time, but at kLastFirstAsked at the latest, when a
/// free oscillation is back at its peak. At kMostPeriods the decision is made with the available evidence.
constexpr double kFirstAsked = 0.6;
constexpr double kEarlier = 2.0 / 32.0;
constexpr double kLastFirstAsked = 1.0;
constexpr double kMostPeriods = 2.5;
/// Part of the time from the onset to the peak whose scans are used; the onset is only estimated.
constexpr double kSurelySlipping = 0.6;
/// Number of blocks from peak to trough of a slip under way.
constexpr double kBlocksPerFall = 16.0;
/// Reach of the parabola through a turning point: a sixteenth of a period, where the course differs from its
/// parabola by (π/8)⁴/24 = 0.1 % of the amplitude; at least the scan on each side.
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

double SlipFollower::period_s() const noexcept { return 2.0 * std::numbers::pi / shared_.omega; }

void SlipFollower::falls(double peak_s, double lowest_s) noexcept {
  const double half_s = std::max(lowest_s - peak_s, scan_s_);
  // From the onset, a quarter of an oscillation before the peak at most, to where it is caught again.
  buffer_.keep_fine(peak_s - half_s, peak_s + 2.0 * half_s, half_s / kBlocksPerFall);
}

void SlipFollower::gap(double now_s) noexcept {
  buffer_.clear();
  gap_s_ = now_s + scan_s_;
  whole_ = false;
  if (rise_slope_ == 0.0) rise_slope_ = base::kNaN;
  if (open_ && !decided_) task_ = Task::kNone;
}

double SlipFollower::freely_next_drop() const noexcept {
  return fall_.drop() * std::exp(-2.0 * std::numbers::pi * shared_.oscillator().gamma_over_2omega());
}

void SlipFollower::open(const Fall& fall, double peak_s, double trough_s, bool begins_from_stick,
                        double sigma) noexcept {
  // A free oscillation only shrinks: what falls by more than that was stuck in between, and the belt has
  // another speed than was thought.
  const bool contradicted = !begins_from_stick && is_more_than(fall.drop(), freely_next_drop(), sigma);
  if (contradicted) begins_from_stick = true;
  open_ = true;
  ++slip_number_;
  decided_ = false;
  begins_from_stick_ = begins_from_stick;
  whole_ = !(peak_s <= gap_s_);
  fall_ = fall;
  peak_s_ = peak_s;
  trough_s_ = trough_s;
  evidence_ = {};
  question_from_s_ = base::kNaN;
  if (!begins_from_stick) last_capture_s_ = base::kNaN;

  const double half_s = std::max(trough_s - peak_s, scan_s_);
  if (begins_from_stick && std::isnan(last_capture_s_)) {
    // Nothing says where the stick began.
    window_from_s_ = rise().line_from_s(buffer_.points(), window_from_s_);
  }
  rise_slope_ = 0.0;
  if (!started_whole_) knowledge_.start(std::numbers::pi / half_s, rise_slope(sigma));
  started_whole_ = started_whole_ || whole_;
  if (contradicted) knowledge_.forget_stick_rate(rise_slope(sigma));
  shared_ = knowledge_.best();

  if (!(typical_delta_mu_ > 0.0)) typical_delta_mu_ = rough_delta_mu(0.5 * fall.drop(), shared_);
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
  next_task_s_ = -std::numeric_limits<double>::infinity();
  if (tier_ == EstimatorTier::kFit && begins_from_stick && !knowledge_.characterised()) {
    task_ = Task::kFirstFit;
  } else {
    task_ = Task::kJudge;
    first_ask();
  }
}

Rise SlipFollower::rise() const noexcept {
  return {fall_.rise_from, fall_.peak, peak_s_ - std::max(fall_.rise_duration, 1.0) * scan_s_, peak_s_};
}

double SlipFollower::rise_slope(double sigma) noexcept {
  if (rise_slope_ == 0.0) {
    rise_slope_ = rise().slope(buffer_.points(), window_from_s_, sigma);
  }
  return rise_slope_;
}

bool SlipFollower::do_task(double now_s, double sigma) noexcept {
  switch (task_) {
    case Task::kFirstFit:
      first_fit(sigma);
      task_ = Task::kJudge;
      first_ask();
      return false;
    case Task::kJudge:
      return judge(now_s, sigma, !(now_s < peak_s_ + kMostPeriods * period_s()));
    case Task::kFit:
      task_ = Task::kNone;
      estimate(now_s, sigma);
      return false;
    case Task::kNone:
      break;
  }
  return false;
}

bool SlipFollower::force(double now_s, double sigma, bool has_next) noexcept {
  if (!open_) return false;
  const bool was_decided = decided_;
  if (task_ == Task::kFirstFit) task_ = Task::kJudge;
  if (task_ == Task::kJudge) (void)judge(now_s, sigma, has_next);
  if (task_ == Task::kFit || (!decided_ && begins_from_stick_)) estimate(now_s, sigma);
  task_ = Task::kNone;
  return decided_ && !was_decided;
}

void SlipFollower::first_fit(double sigma) noexcept {
  // Up to the trough, before which a capture cannot come.
  const estimate::CycleFit fit =
      estimate::fit_cycle(estimate::between(buffer_.points(), window_from_s_, trough_s_), false,
                          first_guess(), knowledge_, sigma);
  if (fit.converged) shared_ = fit.shared;
  question_from_s_ = base::kNaN;
}

double SlipFollower::slipping_before_peak_s() const noexcept {
  if (!begins_from_stick_) return 0.0;
  return kSurelySlipping * std::clamp(peak_s_ - first_guess().onset_s, 0.0, 0.25 * period_s());
}

void SlipFollower::first_ask() noexcept {
  const double period = period_s();
  const double usual_s = std::min(usual_wait_s_ - kEarlier * period, kLastFirstAsked * period);
  next_task_s_ = peak_s_ + std::max(kFirstAsked * period, usual_s);
}

bool SlipFollower::judge(double now_s, double sigma, bool last) noexcept {
  ask(sigma, last ? 0.0 : kDecisive);
  slip_.evidence = evidence_.known ? evidence_.log_likelihood_ratio : base::kNaN;
  // What neither course describes may be neither: an escape then takes more to be believed.
  const double doubt = std::max(evidence_.residual_sigmas / kMisfitSigmas, 1.0);
  const bool clear = evidence_.known && (evidence_.log_likelihood_ratio > kDecisive ||
                                         evidence_.log_likelihood_ratio < -doubt * doubt * kDecisive);
  if (!clear && !last) {
    ask_again(now_s);
    return false;
  }
  task_ = begins_from_stick_ ? Task::kFit : Task::kNone;
  // At the next slip the sign decides; a sled that sticks goes on sticking as long as the scans tell nothing.
  if (!evidence_.known) return false;
  const double told = std::log(kDecisiveLikelihoodRatio);
  if (evidence_.log_likelihood_ratio < 0.0 && evidence_.log_likelihood_ratio > -told) return false;
  decide(evidence_.log_likelihood_ratio, now_s);
  if (std::abs(std::log(shared_.r / knowledge_.best().r)) > kStickRateChange && shared_.r == rise_slope_)
    knowledge_.forget_stick_rate(rise_slope_);
  if (!captured()) return true;
  wait_count_ = std::min(wait_count_ + 1.0, kTypicalMemory);
  usual_wait_s_ += (now_s - peak_s_ - usual_wait_s_) / wait_count_;
  if (!begins_from_stick_)
    slip_.cycle.capture_time_s = last_capture_s_ = window_from_s_ = evidence_.capture_s;
  return true;
}

void SlipFollower::ask(double sigma, double decisive) noexcept {
  if (std::isnan(question_from_s_)) question_from_s_ = peak_s_ - slipping_before_peak_s();
  const auto points = buffer_.since(question_from_s_);
  evidence_ = junction_.ask(points, shared_, sigma, typical_delta_mu_, decisive);
  if (!evidence_.known || !(evidence_.residual_sigmas > kMisfitSigmas)) return;
  // Neither course fits: perhaps the belt has another speed now, which the rise before this slip tells.
  model::SharedParameters other = shared_;
  other.r = rise_slope(sigma);
  if (!(std::abs(std::log(other.r / shared_.r)) > kStickRateChange)) return;
  const JunctionEvidence with_other = junction_.ask(points, other, sigma, typical_delta_mu_);
  if (!belt_changed(with_other.residual_sigmas, evidence_.residual_sigmas)) return;
  evidence_ = with_other;
  shared_ = other;
  question_from_s_ = base::kNaN;
}

bool SlipFollower::belt_changed(double residual_sigmas, double before_sigmas) noexcept {
  if (!BeltChange::explains(residual_sigmas, before_sigmas)) return false;
  const bool seen_before = belt_change_.seen(slip_number_, rise_slope_);
  return seen_before || typical_count_ < kKnownSlips;
}

void SlipFollower::decide(double evidence, double now_s) noexcept {
  decided_ = true;
  slip_.evidence = evidence;
  slip_.decided_time_s = now_s;
  if (evidence > 0.0) slip_.cycle.flags |= kCycleCaptured;
}

model::SlipParameters SlipFollower::first_guess() const noexcept {
  const model::Oscillator oscillator = shared_.oscillator();
  model::SlipParameters guess;
  guess.K = K_of_turning_points(fall_.peak, fall_.trough, oscillator);
  const double above = fall_.peak - guess.K;
  const double D = std::max(slip_of_peak(above, shared_.r, oscillator).delta_mu, 0.1 * above);
  guess.S = guess.K + D;
  guess.onset_s = peak_s_ - model::SlipWaveform{guess.K, D, shared_.r, oscillator}.peak_time_s();
  return guess;
}

void SlipFollower::learn_typical(double delta_mu) noexcept {
  if (!(delta_mu > 0.0)) return;
  typical_count_ = std::min(typical_count_ + 1.0, kTypicalMemory);
  typical_delta_mu_ += (delta_mu - typical_delta_mu_) / typical_count_;
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
  // Scans up to the middle of the stick belong to this slip, the others to the next.
  double end_s = now_s;
  if (decided_ && captured()) {
    end_s =
        0.5 * (evidence_.capture_s + std::min(std::max(now_s, evidence_.capture_s), evidence_.next_onset_s));
  } else if (!decided_) {
    end_s = trough_s_;
  }
  if (tier_ == EstimatorTier::kFit) {
    estimate_by_fit(end_s, sigma);
  } else {
    estimate_by_turning_points(sigma);
  }
  window_from_s_ = end_s;
  buffer_.forget_before(std::min(end_s, peak_s_ + period_s()));
}

void SlipFollower::estimate_by_fit(double end_s, double sigma) noexcept {
  const bool is_captured = decided_ && captured();
  const auto points = estimate::between(buffer_.points(), window_from_s_, end_s);
  estimate::CycleFit fit = estimate::fit_cycle(points, is_captured, first_guess(), knowledge_, sigma);
  if (fit.converged && fit.residual_sigmas > kMisfitSigmas && rise_slope(sigma) > 0.0 &&
      std::abs(std::log(rise_slope_ / knowledge_.best().r)) > kStickRateChange) {
    estimate::SharedKnowledge anew = knowledge_;
    anew.forget_stick_rate(rise_slope_);
    const estimate::CycleFit other = estimate::fit_cycle(points, is_captured, first_guess(), anew, sigma);
    if (other.converged && belt_changed(other.residual_sigmas, fit.residual_sigmas)) {
      knowledge_ = anew;
      fit = other;
    }
  }
  if (!fit.converged) {
    // The next stick begins where this slip was captured, not where one before it was.
    last_capture_s_ = is_captured ? evidence_.capture_s : base::kNaN;
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
  if (!whole_) return;
  const bool mostly_stick = fall_.rise_duration * scan_s_ > kMostlyStick * fall_s;
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
  const TurningPoint peak =
      parabola_vertex(buffer_.points(), peak_s_, reach_s, 1.0).value_or(TurningPoint{peak_s_, fall_.peak});
  const TurningPoint trough = parabola_vertex(buffer_.points(), trough_s_, reach_s, -1.0)
                                  .value_or(TurningPoint{trough_s_, fall_.trough});
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
  take_course(slip, found.slip_speed_ratio, evidence_.capture_s);
  learn_typical(found.delta_mu);
}

}  // namespace stickslip::detect
