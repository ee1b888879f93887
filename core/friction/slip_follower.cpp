#include "core/friction/slip_follower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/friction/capture.hpp"
#include "core/friction/closed_forms.hpp"
#include "core/friction/junction.hpp"
#include "core/friction/regime_rule.hpp"
#include "core/friction/slip_rule.hpp"
#include "core/friction/turning_points.hpp"
#include "core/friction/unknown.hpp"

namespace stickslip::friction {
namespace {

/// ln 10⁴: then one wrong end in ten thousand slips at most [Wald, Ann. Math. Stat. 16:117–186, 1945,
/// (3:42)].
constexpr double kDecisive = 9.210340371976184;
/// The question is asked so often in a period; first when c′ of a slip that escapes is nearly done with
/// rising (t₃ is three quarters of a period after the peak at most), and answered after so many, come what
/// may.
constexpr double kAskedPerPeriod = 32.0;
constexpr double kFirstAsked = 0.6;
constexpr double kMostPeriods = 2.5;
/// Part of the time from the onset to the peak whose scans the question may use: the onset is a guess.
constexpr double kSurelySlipping = 0.6;
/// Blocks of a slip under way: so many from its peak to its trough.
constexpr double kBlocksPerFall = 16.0;
/// Reach of the parabola through a turning point: a sixteenth of a period, where the course differs from its
/// parabola by (π/8)⁴/24 = 0.1 % of the amplitude; at least the scan on each side.
constexpr double kReachPerPeriod = 1.0 / 16.0;
constexpr double kLeastReachScans = 1.6;
/// Parts of a rise between which its slope is the stick rate; the wider ones where a fast loading leaves so
/// few scans between the others that a stray one could bend them.
constexpr double kRiseFrom = 0.3;
constexpr double kRiseTo = 0.7;
constexpr double kFastRiseFrom = 0.1;
constexpr double kFastRiseTo = 0.8;
constexpr std::ptrdiff_t kFewestOfRise = 8;
/// Turning points know ω and r by such parts; only their ratio to what was known before matters.
constexpr double kTurningPointSpread = 0.02;
constexpr double kSlopeSpread = 0.05;
/// After so many slips the stick rate is known from more than a loading, and one rise does not overturn it.
constexpr double kKnownSlips = 2.0;
/// Rises of so many falls are mostly stick, and their middle is.
constexpr double kMostlyStick = 3.0;
/// The typical S − K follows the last so many.
constexpr double kTypicalMemory = 16.0;
/// Peaks between scans are off by this part of a drop.
constexpr double kPeakError = 0.02;

/// By which a drop is wrong at most: noise of both its ends as far as it makes no turning point, and what is
/// missed between scans.
double peak_error(double drop, double sigma) noexcept {
  return std::numbers::sqrt2 * SlipRule::kHysteresisSigmas * sigma + kPeakError * drop;
}

double log_normal_density(double x, double mean, double deviation) noexcept {
  const double z = (x - mean) / deviation;
  return -0.5 * z * z - std::log(deviation);
}

}  // namespace

double SlipFollower::period_s() const noexcept { return 2.0 * std::numbers::pi / shared_.omega; }

void SlipFollower::falls(double peak_s, double lowest_s) noexcept {
  const double half_s = std::max(lowest_s - peak_s, scan_s_);
  // From the onset, a quarter of an oscillation before the peak at most, to where it is caught again.
  buffer_.keep_fine(peak_s - half_s, peak_s + 2.0 * half_s, half_s / kBlocksPerFall);
}

void SlipFollower::gap() noexcept {
  buffer_.clear();
  if (open_ && !decided_) task_ = Task::kNone;
}

void SlipFollower::open(const Fall& fall, double peak_s, double trough_s, bool begins_from_stick,
                        double sigma) noexcept {
  // A free oscillation only shrinks: what falls by more than that was stuck in between, and the belt has
  // another speed than was thought.
  const bool contradicted =
      !begins_from_stick && fall.drop() > freely_next_drop() + peak_error(fall.drop(), sigma);
  if (contradicted) begins_from_stick = true;
  open_ = true;
  ++slip_number_;
  decided_ = false;
  begins_from_stick_ = begins_from_stick;
  fall_ = fall;
  peak_s_ = peak_s;
  trough_s_ = trough_s;
  evidence_ = {};
  question_from_s_ = kNotKnown;
  if (!begins_from_stick) last_capture_s_ = kNotKnown;

  const double half_s = std::max(trough_s - peak_s, scan_s_);
  const double rise = fall.peak - fall.rise_from;
  if (begins_from_stick && std::isnan(last_capture_s_)) {
    // Nothing says where the stick began: a first loading has a rounded start, and rest before it.
    for (const CyclePoint& point : between(buffer_.points(), window_from_s_, peak_s)) {
      if (point.value < fall.rise_from + kRiseFrom * rise) window_from_s_ = point.last_s + 0.5 * scan_s_;
    }
  }
  rise_slope_ = slope_of_rise(fall, peak_s, sigma);
  if (!knowledge_.started()) knowledge_.start(std::numbers::pi / half_s, rise_slope_);
  if (contradicted) knowledge_.forget_stick_rate(rise_slope_);
  shared_ = knowledge_.best();

  if (!(typical_delta_mu_ > 0.0)) {
    const double belt = shared_.r / shared_.omega;
    const double amplitude = 0.5 * fall.drop();
    typical_delta_mu_ =
        std::sqrt(std::max(amplitude * amplitude - belt * belt, 0.01 * amplitude * amplitude));
  }
  slip_ = {};
  Cycle& cycle = slip_.cycle;
  cycle.peak_time_s = peak_s;
  cycle.peak = fall.peak;
  cycle.trough = fall.trough;
  cycle.force_drop = fall.drop();
  for (double* unknown :
       {&cycle.onset_time_s, &cycle.capture_time_s, &cycle.period_s, &cycle.stick_time_s, &cycle.slip_time_s,
        &cycle.delta_mu, &cycle.delta_mu_standard_error, &cycle.slip_speed_ratio}) {
    *unknown = kNotKnown;
  }
  next_task_s_ = -std::numeric_limits<double>::infinity();
  if (tier_ == EstimatorTier::kPeak) {
    task_ = Task::kNone;
  } else if (tier_ == EstimatorTier::kFit && begins_from_stick && !knowledge_.characterised()) {
    task_ = Task::kFirstFit;
  } else {
    task_ = Task::kJudge;
    next_task_s_ = peak_s + kFirstAsked * period_s();
  }
}

double SlipFollower::slope_of_rise(const Fall& fall, double peak_s, double sigma) const noexcept {
  const double rise = fall.peak - fall.rise_from;
  const double whole = rise / (std::max(fall.rise_duration, 1.0) * scan_s_);
  if (!keeps_scans()) return whole;
  const auto before =
      between(buffer_.points(), std::max(window_from_s_, peak_s - fall.rise_duration * scan_s_), peak_s);
  const auto level = [&](double part) { return fall.rise_from + part * rise; };
  const bool few = std::ranges::count_if(before, [&](const CyclePoint& point) {
                     return point.value >= level(kRiseFrom) && point.value <= level(kRiseTo);
                   }) < kFewestOfRise;
  const double slope =
      slope_between(before, level(few ? kFastRiseFrom : kRiseFrom), level(few ? kFastRiseTo : kRiseTo), sigma)
          .value_or(0.0);
  return slope > 0.0 ? slope : whole;
}

bool SlipFollower::do_task(double now_s, double sigma) noexcept {
  switch (task_) {
    case Task::kFirstFit:
      first_fit(sigma);
      task_ = Task::kJudge;
      next_task_s_ = peak_s_ + kFirstAsked * period_s();
      return false;
    case Task::kJudge:
      return judge(now_s, sigma, now_s > peak_s_ + kMostPeriods * period_s());
    case Task::kFit:
      task_ = Task::kNone;
      estimate(now_s, sigma);
      return false;
    case Task::kNone:
      break;
  }
  return false;
}

bool SlipFollower::force(double now_s, double sigma, const Fall* next) noexcept {
  if (!open_) return false;
  if (tier_ == EstimatorTier::kPeak) {
    if (next == nullptr) return false;
    judge_by_heights(*next, sigma);
    decided_ = true;
    slip_.decided_time_s = now_s;
    return true;
  }
  bool now_decided = false;
  if (task_ == Task::kFirstFit) task_ = Task::kJudge;
  if (task_ == Task::kJudge) now_decided = judge(now_s, sigma, next != nullptr);
  if (task_ == Task::kFit || (!decided_ && begins_from_stick_)) estimate(now_s, sigma);
  task_ = Task::kNone;
  return now_decided;
}

void SlipFollower::first_fit(double sigma) noexcept {
  // Up to the trough, before which a capture cannot come.
  const CycleFit fit = fit_cycle(between(buffer_.points(), window_from_s_, trough_s_), false, first_guess(),
                                 knowledge_, sigma);
  if (fit.converged) shared_ = fit.shared;
  question_from_s_ = kNotKnown;
}

double SlipFollower::slipping_before_peak_s() const noexcept {
  if (!begins_from_stick_) return 0.0;
  return kSurelySlipping * std::clamp(peak_s_ - first_guess().onset_s, 0.0, 0.25 * period_s());
}

bool SlipFollower::judge(double now_s, double sigma, bool last) noexcept {
  if (std::isnan(question_from_s_)) question_from_s_ = peak_s_ - slipping_before_peak_s();
  const auto points = buffer_.since(question_from_s_);
  evidence_ = junction_.ask(points, shared_, sigma, typical_delta_mu_, last ? 0.0 : kDecisive);
  if (evidence_.known && evidence_.residual_sigmas > kMisfitSigmas) {
    // Neither course fits: perhaps the belt has another speed now, which the rise before this slip tells.
    SharedParameters other = shared_;
    other.r = rise_slope_;
    const JunctionEvidence with_other = junction_.ask(points, other, sigma, typical_delta_mu_);
    if (belt_changed(with_other.residual_sigmas, evidence_.residual_sigmas)) {
      evidence_ = with_other;
      shared_ = other;
      question_from_s_ = kNotKnown;
    }
  }
  slip_.evidence = evidence_.known ? evidence_.log_likelihood_ratio : kNotKnown;
  // What neither course describes may be neither: an escape then takes more to be believed.
  const double doubt = std::max(evidence_.residual_sigmas / kMisfitSigmas, 1.0);
  const bool clear = evidence_.known && (evidence_.log_likelihood_ratio > kDecisive ||
                                         evidence_.log_likelihood_ratio < -doubt * doubt * kDecisive);
  if (!clear && !last) {
    next_task_s_ = now_s + period_s() / kAskedPerPeriod;
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
  if (!begins_from_stick_ && captured()) {
    slip_.cycle.capture_time_s = last_capture_s_ = window_from_s_ = evidence_.capture_s;
  }
  return true;
}

bool SlipFollower::belt_changed(double residual_sigmas, double before_sigmas) noexcept {
  if (!BeltChange::explains(residual_sigmas, before_sigmas)) return false;
  const bool seen_before = belt_change_.seen(slip_number_, rise_slope_);
  return seen_before || typical_count_ < kKnownSlips;
}

double SlipFollower::freely_next_drop() const noexcept {
  return fall_.drop() * std::exp(-2.0 * std::numbers::pi * shared_.oscillator().gamma_over_2omega());
}

void SlipFollower::judge_by_heights(const Fall& next, double sigma) noexcept {
  // A free oscillation falls next time by what damping leaves; a slip from sticking by what is usual.
  const double drop = next.drop();
  const double free = freely_next_drop();
  const double scans = std::numbers::sqrt2 * sigma;
  const double between_scans = kPeakError * free;
  const double noise = std::sqrt(scans * scans + between_scans * between_scans);
  if (typical_count_ == 0.0) typical_log_drop_ = std::log(fall_.drop());
  const double log_drop = std::log(drop);
  const double off_usual = log_drop - typical_log_drop_;
  const double as_captured = log_normal_density(off_usual, 0.0, kDeltaMuLogScatter) - log_drop;
  decide(as_captured - log_normal_density(drop, free, noise), slip_.decided_time_s);
  if (!captured()) return;
  typical_count_ = std::min(typical_count_ + 1.0, kTypicalMemory);
  typical_log_drop_ += off_usual / typical_count_;
}

void SlipFollower::decide(double evidence, double now_s) noexcept {
  decided_ = true;
  slip_.evidence = evidence;
  slip_.decided_time_s = now_s;
  if (evidence > 0.0) slip_.cycle.flags |= kCycleCaptured;
}

SlipParameters SlipFollower::first_guess() const noexcept {
  const Oscillator oscillator = shared_.oscillator();
  SlipParameters guess;
  guess.K = K_of_turning_points(fall_.peak, fall_.trough, oscillator);
  const double above = fall_.peak - guess.K;
  const double D = std::max(delta_mu_of_peak(above, shared_.r, oscillator), 0.1 * above);
  guess.S = guess.K + D;
  guess.onset_s = peak_s_ - SlipWaveform{guess.K, D, shared_.r, oscillator}.peak_time_s();
  return guess;
}

void SlipFollower::learn_typical(double delta_mu) noexcept {
  if (!(delta_mu > 0.0)) return;
  typical_count_ = std::min(typical_count_ + 1.0, kTypicalMemory);
  typical_delta_mu_ *= std::pow(delta_mu / typical_delta_mu_, 1.0 / typical_count_);
}

void SlipFollower::take_course(const SharedParameters& shared, const SlipParameters& slip) noexcept {
  Cycle& cycle = slip_.cycle;
  slip_.S = slip.S;
  slip_.K = slip.K;
  cycle.onset_time_s = slip.onset_s;
  cycle.stick_time_s = slip.onset_s - last_capture_s_;
  cycle.delta_mu = slip.S - slip.K;
  const SlipWaveform waveform{slip.K, slip.S - slip.K, shared.r, shared.oscillator()};
  cycle.slip_speed_ratio = -waveform.rate(waveform.fastest_slip_time_s()) / shared.r;
  last_capture_s_ = kNotKnown;
  if (!captured()) return;
  cycle.slip_time_s = capture_time_s(waveform, shared.r).value_or(waveform.rise_end_time_s());
  cycle.capture_time_s = slip.onset_s + cycle.slip_time_s;
  last_capture_s_ = cycle.capture_time_s;
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
    estimate_by_turning_points();
  }
  window_from_s_ = end_s;
  buffer_.forget_before(std::min(end_s, peak_s_ + period_s()));
}

void SlipFollower::estimate_by_fit(double end_s, double sigma) noexcept {
  const bool is_captured = decided_ && captured();
  const auto points = between(buffer_.points(), window_from_s_, end_s);
  CycleFit fit = fit_cycle(points, is_captured, first_guess(), knowledge_, sigma);
  if (fit.converged && fit.residual_sigmas > kMisfitSigmas && rise_slope_ > 0.0 &&
      std::abs(std::log(rise_slope_ / knowledge_.best().r)) > kStickRateChange) {
    SharedKnowledge anew = knowledge_;
    anew.forget_stick_rate(rise_slope_);
    const CycleFit other = fit_cycle(points, is_captured, first_guess(), anew, sigma);
    if (other.converged && belt_changed(other.residual_sigmas, fit.residual_sigmas)) {
      knowledge_ = anew;
      fit = other;
    }
  }
  if (!fit.converged) return;
  take_course(fit.shared, fit.slip);
  slip_.cycle.delta_mu_standard_error = std::sqrt(std::max(fit.delta_mu_variance(), 0.0));
  learn_typical(fit.delta_mu());
  if (fit.residual_sigmas < kMisfitSigmas) knowledge_.learn(fit.evidence);
}

void SlipFollower::estimate_by_turning_points() noexcept {
  const double reach_s = std::max(kReachPerPeriod * period_s(), kLeastReachScans * scan_s_);
  const TurningPoint peak =
      parabola_vertex(buffer_.points(), peak_s_, reach_s, 1.0).value_or(TurningPoint{peak_s_, fall_.peak});
  const TurningPoint trough = parabola_vertex(buffer_.points(), trough_s_, reach_s, -1.0)
                                  .value_or(TurningPoint{trough_s_, fall_.trough});
  slip_.cycle.peak_time_s = peak.time_s;
  slip_.cycle.peak = peak.value;
  slip_.cycle.trough = trough.value;
  slip_.cycle.force_drop = peak.value - trough.value;
  SharedEvidence evidence;
  const double omega = std::numbers::pi / std::max(trough.time_s - peak.time_s, scan_s_);
  evidence.information(0, 0) = 1.0 / (kTurningPointSpread * omega * kTurningPointSpread * omega);
  if (fall_.rise_duration * scan_s_ > kMostlyStick * (trough.time_s - peak.time_s))
    evidence.information(2, 2) = 1.0 / (kSlopeSpread * rise_slope_ * kSlopeSpread * rise_slope_);
  evidence.weighted = {evidence.information(0, 0) * omega, 0.0, evidence.information(2, 2) * rise_slope_};
  knowledge_.learn(evidence);
  const SharedParameters& shared = knowledge_.best();
  const Oscillator oscillator = shared.oscillator();
  SlipParameters slip;
  slip.K = K_of_turning_points(peak.value, trough.value, oscillator);
  const double D = delta_mu_of_peak(peak.value - slip.K, shared.r, oscillator);
  slip.S = slip.K + D;
  slip.onset_s = peak.time_s - SlipWaveform{slip.K, D, shared.r, oscillator}.peak_time_s();
  take_course(shared, slip);
  learn_typical(D);
}

}  // namespace stickslip::friction
