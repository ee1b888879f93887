#include "core/analysis/test_analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/analysis/cycle_statistics.hpp"
#include "core/analysis/hum_check.hpp"
#include "core/analysis/ladder.hpp"
#include "core/analysis/live_estimates.hpp"
#include "core/analysis/model_results.hpp"
#include "core/analysis/sections.hpp"
#include "core/analysis/signal_check.hpp"
#include "core/analysis/slack.hpp"
#include "core/analysis/slip_list.hpp"
#include "core/analysis/test_fit.hpp"
#include "core/analysis/traditional.hpp"
#include "core/base/contract.hpp"
#include "core/base/nan.hpp"
#include "core/detect/regime_rule.hpp"
#include "core/estimate/sampling.hpp"
#include "core/signal/statistics.hpp"
#include "core/signal/whiteness.hpp"

namespace stickslip::analysis {
namespace {

/// Smallest noise assumed, relative to the largest value: a trace without any noise or steps (a
/// closed form in doubles) still has rounding, and turning points need a scale.
constexpr double kSmallestRelativeNoise = 1e-9;

double noise_floor(const base::LongColumn<double>& values, double step_coefficient) {
  const double step = step_coefficient > 0.0 ? step_coefficient : signal::smallest_step(values);
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return std::max(
      {signal::kRoundingSigma * step, kSmallestRelativeNoise * largest, std::numeric_limits<double>::min()});
}

/// What a check of the signal reads in another thread.
struct Signal {
  estimate::Trace trace;
  base::LongColumn<double> measured;
  base::LongColumn<std::uint8_t> saturated;
  AnalysisSettings settings;
};

/// What a search for hum reads in another thread.
struct Loaded {
  estimate::Trace trace;
  base::LongColumn<detect::Fall> slips;
  double scan_rate_Hz;
};

/// Turning points must not follow noise before the noise is known.
double hysteresis(double sigma) { return detect::SlipRule::kHysteresisSigmas * sigma; }

base::LongColumn<detect::Fall> find_slips(const estimate::Trace& trace, double sigma,
                                          const std::filesystem::path& scratch) {
  detect::FallFinder finder;
  detect::SlipRule rule;
  base::LongColumn<detect::Fall> slips{scratch};
  for (const double value : trace.value) {
    if (const auto fall = finder.add(value, hysteresis(sigma)); fall && rule.is_slip(*fall, sigma)) {
      slips.push_back(*fall);
    }
  }
  return kept_slips(std::move(slips), scratch);
}

constexpr const char* kHiddenOscillation =
    "no fall stands out of the noise, but the noise is not white: hum, or an oscillation of fewer than nine "
    "scans a cycle; scan more often";

/// What the model has found, beside what needs no model.
void take_model_results(const TestResults& model, TestResults& results) {
  std::vector<const Estimate*> from;
  for_each_result(model, [&](const ResultName&, const Estimate& estimate) { from.push_back(&estimate); });
  std::size_t i = 0;
  for_each_result(results, [&](const ResultName&, Estimate& estimate) {
    const Estimate& found = *from[i++];
    if (found.value || !found.reason.empty()) estimate = found;
  });
}

/// Of the regime: 0 where the sled never sticks; else a reason where fewer than half of the slips tell how
/// they ended. The last one never does.
Estimate stick_cycle_count(const detect::RegimeVerdict& verdict, std::size_t slip_count) {
  if (verdict.regime == model::Regime::kUndecided) return Estimate::none("undecided: " + verdict.reason);
  if (!verdict.captured) return Estimate::none("no fit tells which slips ended in sticking");
  if (*verdict.captured > 0 && 2 * (verdict.told + 1) < slip_count) {
    return Estimate::none(fmt::format("{} of {} slips tell how they ended, {} of them in sticking",
                                      verdict.told, slip_count, *verdict.captured));
  }
  return Estimate::of(static_cast<double>(*verdict.captured));
}

/// Scans too few for the oscillation that was found.
std::optional<base::Finding> sampling_finding(double scan_rate_Hz, const TestResults& results) {
  const Estimate& cycles_Hz = results.oscillation_frequency;
  if (!results.omega.value && !cycles_Hz.value) return std::nullopt;
  // No cycle is shorter than an oscillation; one that the model fits among too few scans may be a slower one.
  const double frequency_Hz =
      std::max(results.omega.value.value_or(0.0) / (2.0 * std::numbers::pi), cycles_Hz.value.value_or(0.0));
  const double scans = scan_rate_Hz / frequency_Hz;
  if (scans >= estimate::kFewScansACycle) return std::nullopt;
  const double needed_Hz = std::ceil(estimate::kFewScansACycle * frequency_Hz);
  return base::make_finding(
      base::FindingCode::kFewScans,
      fmt::format(
          "{:.2g} scans a cycle of {:.3g} Hz: peaks are missed, and perhaps slips; {:.0f} scans/s or more",
          scans, frequency_Hz, needed_Hz),
      {{"scans_in_cycle", scans, "1"},
       {"frequency", frequency_Hz, "Hz"},
       {"scan_rate_needed", needed_Hz, "Hz"}});
}

detect::LiveSettings live_settings(const AnalysisSettings& settings) {
  return {settings.scan_rate_Hz, settings.step_coefficient, settings.estimator, settings.prior,
          !settings.skipped.spikes};
}

/// A stub of a test: without the noise there is no telling what is a slip.
void too_short(std::size_t scan_count, TestResults& results) {
  results.regime_reason =
      fmt::format("{} scans, {} are needed to know their noise", scan_count, signal::kFewestScansForNoise);
  no_model_results(results.regime_reason, results);
  results.rung_reason = results.regime_reason;
  for (Estimate* estimate :
       {&results.cycle_count, &results.stick_cycle_count, &results.period_median,
        &results.oscillation_frequency, &results.static_coefficient, &results.kinetic_coefficient,
        &results.drift_rate, &results.smallest_slip, &results.misfit, &results.mu_slope}) {
    *estimate = Estimate::none(results.regime_reason);
  }
}

}  // namespace

TestAnalysis::TestAnalysis(const AnalysisSettings& settings)
    : settings_(settings),
      indices_(settings.scratch_folder),
      coefficients_(settings.scratch_folder),
      saturated_(settings.scratch_folder),
      speeds_m_per_s_(settings.scratch_folder),
      live_(live_settings(settings)),
      live_cycles_(settings.scratch_folder) {
  constexpr std::size_t kRoom = 100;
  new_cycles_.reserve(kRoom);
  new_falls_.reserve(kRoom);
  if (!(settings.scan_rate_Hz > 0.0) || !std::isfinite(settings.scan_rate_Hz)) {
    throw std::invalid_argument(fmt::format("scan rate {} Hz must be positive", settings.scan_rate_Hz));
  }
}

void TestAnalysis::speed(double speed_m_per_s) {
  // What is not known is taken for what it was before.
  if (std::isnan(speed_m_per_s)) {
    speed_m_per_s =
        speeds_m_per_s_.empty() ? 0.0 : std::as_const(speeds_m_per_s_)[speeds_m_per_s_.size() - 1];
  }
  speeds_m_per_s_.push_back(speed_m_per_s);
}

void TestAnalysis::add(base::ScanIndex index, double coefficient, bool saturated) {
  indices_.push_back(index);
  coefficients_.push_back(coefficient);
  saturated_.push_back(saturated ? 1 : 0);
  if (!settings_.live) return;
  if (const auto cycle = live_.add(coefficient, saturated)) keep_live(*cycle);
  if (const auto& fall = live_.fall_begun()) {
    const auto peak = static_cast<std::size_t>(fall->peak_scan);
    new_falls_.push_back({std::as_const(indices_)[peak], fall->peak, index});
  }
}

void TestAnalysis::keep_live(const detect::LiveCycle& cycle) {
  detect::LiveCycle kept = cycle;
  kept.cycle.first_scan += indices_.front();
  if (std::isfinite(cycle.decided_time_s)) {
    kept.cycle.live_capture_evidence = cycle.evidence;
    kept.cycle.live_decision_time_s = cycle.decided_time_s;
  }
  if (settings_.live) new_cycles_.push_back(kept.cycle);
  live_cycles_.push_back(kept);
}

void TestAnalysis::end_live() {
  STICKSLIP_EXPECTS(settings_.live);
  if (const auto cycle = live_.end()) keep_live(*cycle);
}

void TestAnalysis::gap(base::ScanIndex first, std::int64_t count, bool estimated) {
  gaps_.push_back({first, count, estimated});
  if (settings_.live) live_.gap(count);
}

std::vector<detect::Cycle> TestAnalysis::take_new_cycles() {
  STICKSLIP_EXPECTS(settings_.live);
  std::vector<detect::Cycle> taken = new_cycles_;
  new_cycles_.clear();  // Their room stays.
  return taken;
}

std::vector<detect::FallBegun> TestAnalysis::take_new_falls() {
  STICKSLIP_EXPECTS(settings_.live);
  std::vector<detect::FallBegun> taken = new_falls_;
  new_falls_.clear();  // Their room stays.
  return taken;
}

TestResults TestAnalysis::finish() {
  // What has no thread, also where there is no room for one, runs when it is asked. A task has a name: async
  // moves what it is given before it knows whether there is room.
  const auto policy_of = [](bool on_a_thread) {
    return on_a_thread ? std::launch::async | std::launch::deferred : std::launch::deferred;
  };
  const auto detection_by = [&](detect::EstimatorTier estimator) {
    detect::LiveSettings live = live_settings(settings_);
    live.estimator = estimator;
    const auto scans = std::make_shared<const Scans>(
        Scans{indices_.view(), coefficients_.view(), saturated_.view(), gaps_, settings_.scratch_folder});
    return [live, scans] { return detected(live, *scans); };
  };
  std::future<base::LongColumn<detect::LiveCycle>> detection;
  if (settings_.live) {
    end_live();
  } else {
    const auto task = detection_by(settings_.estimator);
    detection = std::async(policy_of(true), task);
  }
  const auto end_detection = [&] {
    if (!detection.valid()) return;
    const base::LongColumn<detect::LiveCycle> cycles = detection.get();
    for (const detect::LiveCycle& cycle : cycles) keep_live(cycle);
  };
  TestResults results;
  std::int64_t lost = 0;
  for (const Gap& gap : gaps_) lost += gap.count;
  results.gap_count = Estimate::of(static_cast<double>(gaps_.size()));
  results.lost_scan_count = Estimate::of(static_cast<double>(lost));
  results.scan_rate_measured = Estimate::none("no clock readings in the analysis");
  results.transition_time = Estimate::none("no transition");

  estimate::Trace trace = despiked_trace();
  const auto signal = std::make_shared<const Signal>(
      Signal{trace.view(), coefficients_.view(), saturated_.view(), settings_});
  const auto check_task = [signal] {
    return check_signal(signal->trace, signal->measured, signal->saturated, signal->settings.step_coefficient,
                        signal->settings.scan_rate_Hz);
  };
  std::future<SignalCheck> checking = std::async(policy_of(!settings_.live), check_task);
  results.spike_count = settings_.skipped.spikes ? Estimate::none("spikes are kept, and not looked for")
                                                 : Estimate::of(static_cast<double>(spikes_.size()));
  if (trace.size() < signal::kFewestScansForNoise) {
    too_short(trace.size(), results);
    no_bootstrap(results.regime_reason);
    return results;
  }
  const double sigma = signal::scan_noise(trace.value, noise_floor(trace.value, settings_.step_coefficient));
  base::LongColumn<detect::Fall> slips = find_slips(trace, sigma, settings_.scratch_folder);
  const SignalCheck check = checking.get();
  leave_out(check, trace);
  break_at_gaps(trace, slips);
  read_speeds(trace);
  if (!slips.empty()) {
    follow_speed(trace, slips);
    follow_holds(trace, slips, sigma, results);
  }
  const auto loaded =
      std::make_shared<const Loaded>(Loaded{trace.view(), slips.view(), settings_.scan_rate_Hz});
  const auto hum_task = [loaded] { return find_hum(loaded->trace, loaded->slips, loaded->scan_rate_Hz); };
  std::future<std::optional<Hum>> humming = std::async(policy_of(!settings_.live), hum_task);
  results.cycle_count = Estimate::of(static_cast<double>(slips.size()));
  results.smallest_slip = Estimate::of(detect::SlipRule::kSignificantSigmas * sigma);
  const TraditionalCoefficients traditional =
      traditional_coefficients(trace, slips, settings_.method, settings_.tester.pull_speed_m_per_s);
  results.static_coefficient =
      traditional.static_coefficient.value && begins_under_load(trace)
          ? Estimate::none("the trace begins under load: the peak before the first slip is not in it")
          : traditional.static_coefficient;
  results.kinetic_coefficient = traditional.kinetic_coefficient;
  const Slack slack = find_slack(trace, slips, sigma);
  if (slips.empty()) {
    const detect::RegimeVerdict verdict = detect::judge_regime(0, {}, detect::Description::kFits);
    results.regime = verdict.regime;
    results.regime_reason = verdict.reason;
    results.stick_cycle_count = Estimate::of(0.0);
    if (signal::hides_an_oscillation(trace.value, noise_floor(trace.value, settings_.step_coefficient))) {
      results.regime = model::Regime::kUndecided;
      results.regime_reason = kHiddenOscillation;
      results.cycle_count = results.stick_cycle_count = Estimate::none(kHiddenOscillation);
    }
    no_model_results("no slip", results);
    results.rung_reason = "no slip";
    results.misfit = results.mu_slope = Estimate::none("no slip");
    no_bootstrap("no slip");
  } else {
    const bool is_fitted = fits_whole_test() && slack.count == 0;
    const std::string why_no_K = slack.count > 0 ? why_slack(slack.count, slips.size()) : "";
    const bool mostly_slack = 2 * slack.count > slips.size();
    if (!fits_whole_test()) end_detection();
    // Seen once more, by turning points: beside the fits from where they are likely to be needed.
    std::future<base::LongColumn<detect::LiveCycle>> seen_again;
    const auto see_again = [&] {
      const auto task = detection_by(detect::EstimatorTier::kTurningPoints);
      seen_again = std::async(policy_of(!settings_.live), task);
    };
    const auto turning_points = [&] {
      return seen_again.valid() ? seen_again.get() : detection_by(detect::EstimatorTier::kTurningPoints)();
    };
    TestFit fit{settings_};
    TestEstimates estimates =
        is_fitted ? fit.estimate(trace, slips, sigma, see_again)
        : slack.count > 0
            ? by_turning_points(trace, slips, turning_points(), why_no_K, mostly_slack ? Slack{} : slack)
            : by_turning_points(
                  trace, slips, live_cycles_,
                  fmt::format(
                      "the estimator \"{}\" does not fit the whole test; \"fit\" does, also afterwards",
                      detect::name(settings_.estimator)));
    if (slack.count > 0) {
      estimates.model_describes = false;
    } else if (!estimates.model_describes) {
      const std::string why = estimates.results.delta_mu.reason;
      const TestEstimates fitted = std::move(estimates);
      estimates = by_turning_points(trace, slips, turning_points(), why);
      estimates.model_describes = false;
      estimates.misfit = fitted.misfit;
      add_distance_to_fits(fitted.cycles, estimates.results);
      base::add(results.findings, turning_points_finding(estimates.results.delta_mu, why));
    }
    if (is_fitted) {
      take_misfit(estimates.misfit, results);
    } else {
      results.misfit = Estimate::none(estimates.rung_reason);
    }
    if (fits_whole_test() && estimates.model_describes && estimates.misfit.is_significant() &&
        trace.belt.is_constant()) {
      add_distance(by_turning_points(trace, slips, turning_points(), {}).results, estimates.results);
      if (estimates.misfit.is_certain())
        base::add(results.findings, misfit_finding(estimates.misfit, estimates.results));
    }
    results.rung = estimates.rung;
    results.rung_reason = estimates.rung_reason;
    const bool refuted = estimates.misfit.is_large();
    const auto description = estimates.model_describes ? detect::Description::kFits
                             : refuted                 ? detect::Description::kRefuted
                                                       : detect::Description::kDoubtful;
    detect::RegimeVerdict verdict =
        detect::judge_regime(slips.size(), estimates.log_likelihood_ratios, description);
    if (refuted && trace.belt.is_constant()) {
      verdict =
          detect::judge_by_shape(cycle_shape(trace, slips), std::move(verdict), estimates.model_describes);
    }
    results.regime = verdict.regime;
    results.regime_reason = verdict.reason;
    results.stick_cycle_count = stick_cycle_count(verdict, slips.size());
    if (slack.count > 0) {
      if (mostly_slack) void_slack_turns(why_no_K, verdict.regime, estimates.results);
      base::add(results.findings, slack_finding(slack.count, slips.size()));
    }
    if (is_fitted && !estimates.model_describes)
      add_distance_to_mean_force(mean_force(trace, slips), estimates.results);
    take_model_results(estimates.results, results);
    tester_ = fit.tester();
    tester_check_ = fit.tester_check();
    if (!settings_.tester.transducer.is_ideal() && !fit.took_transducer_off()) {
      base::add(
          results.findings,
          base::make_finding(base::FindingCode::kTransducerShows,
                             "the load cell and filter that are stated are not taken off the trace: S and K "
                             "are as read"));
    }
    if (!fits_whole_test()) {
      no_bootstrap("turning points are no fit: --estimator fit");
      results.mu_slope = Estimate::none("turning points tell no damping");
    } else {
      if (settings_.bootstrap.count > 0) bootstrap_ = fit.bootstrap(trace, sigma, estimates);
      results.mu_slope = fit.mu_slope(trace, slips, sigma, estimates);
    }
    if (fits_whole_test() && estimates.model_describes) speed_results(trace, estimates, results);
    if (verdict.transition_slip) {
      results.transition_time = transition_time(trace, estimates, slips, *verdict.transition_slip);
    }
    end_detection();
    keep_cycles(trace, estimates, slips, [&](const detect::Fall& slip) {
      return results.delta_mu.value && !check.voids() && !slack.holds(trace, slip);
    });
  }
  period_results(trace, slips, results);
  if (const auto hum = humming.get()) base::add(results.findings, hum_finding(*hum, results.regime));
  if (auto finding = sampling_finding(settings_.scan_rate_Hz, results))
    base::add(results.findings, *std::move(finding));
  if (slack.count == 0) {
    if (auto finding = level_finding(trace, slips)) base::add(results.findings, *std::move(finding));
  }
  results.drift_rate = drift_of(trace, slips);
  void_results(check, results);
  if (check.voids()) {
    tester_.reset();
    tester_check_.reset();
  }
  // By the signal, or as the sled may never have stuck.
  if (!results.delta_mu.value && !slips.empty()) no_bootstrap(results.delta_mu.reason);
  add_signal_findings(check, trace.size(), results);
  return results;
}

void TestAnalysis::leave_out(const SignalCheck& check, estimate::Trace& trace) {
  const auto held = check.held();
  if (!held) return;
  // A column in a file can be read but not changed.
  base::LongColumn<std::uint8_t> usable{settings_.scratch_folder};
  base::LongColumn<std::uint8_t> saturated{settings_.scratch_folder};
  for (std::size_t k = 0; k < trace.size(); ++k) {
    const bool is_held = std::as_const(trace.usable)[k] != 0 && held->holds(std::as_const(coefficients_)[k]);
    usable.push_back(is_held ? 0 : std::as_const(trace.usable)[k]);
    saturated.push_back(is_held ? 1 : std::as_const(saturated_)[k]);
  }
  trace.usable = std::move(usable);
  saturated_ = std::move(saturated);
}

estimate::Trace TestAnalysis::despiked_trace() {
  const std::filesystem::path& scratch = settings_.scratch_folder;
  estimate::Trace trace{base::LongColumn<double>{scratch},
                        base::LongColumn<double>{scratch},
                        base::LongColumn<std::uint8_t>{scratch},
                        {},
                        {}};
  const double sigma =
      signal::scan_noise(coefficients_, noise_floor(coefficients_, settings_.step_coefficient));
  signal::Despiker despiker;
  spikes_.clear();
  spike_coefficients_.clear();
  const base::LongColumn<base::ScanIndex>& indices = indices_;
  const base::LongColumn<std::uint8_t>& saturated = saturated_;
  const base::LongColumn<double>& measured = coefficients_;
  const auto take = [&](const signal::DespikedScan& scan) {
    const std::size_t k = trace.value.size();
    if (scan.spike) {
      spikes_.push_back(indices[k]);
      spike_coefficients_.push_back(measured[k]);
    }
    trace.time_s.push_back(static_cast<double>(indices[k] - indices.front()) / settings_.scan_rate_Hz);
    trace.value.push_back(scan.value);
    trace.usable.push_back(!scan.spike && saturated[k] == 0 ? 1 : 0);
  };
  for (const double coefficient : measured) {
    if (settings_.skipped.spikes) {
      take({coefficient, false});
    } else if (const auto scan = despiker.add(coefficient, sigma)) {
      take(*scan);
    }
  }
  while (const auto scan = despiker.flush(sigma)) take(*scan);
  return trace;
}

Estimate TestAnalysis::transition_time(const estimate::Trace& trace, const TestEstimates& estimates,
                                       const base::LongColumn<detect::Fall>& slips, std::size_t slip) {
  const double onset_s = estimates.cycles[slip].onset_time_s;
  // A slip that did not begin from sticking has no onset: its peak has to do.
  if (!std::isfinite(onset_s)) return Estimate::of(estimate::time_at(trace, slips[slip].peak_at));
  return Estimate::of(onset_s, estimates.onset_errors_s[slip]);
}

TestEstimates TestAnalysis::by_turning_points(const estimate::Trace& trace,
                                              const base::LongColumn<detect::Fall>& slips,
                                              const base::LongColumn<detect::LiveCycle>& cycles,
                                              std::string reason, const Slack& slack) const {
  LiveSettlement settlement;
  settlement.slack = slack;
  settlement.first_counts = settings_.skipped.first_slip;
  settlement.reason = std::move(reason);
  TestEstimates estimates = estimates_from_live(trace, slips, cycles, settlement, settings_.scratch_folder);
  estimates.rung = Rung::kTurningPoints;
  estimates.rung_reason = settlement.reason;
  return estimates;
}

base::LongColumn<detect::LiveCycle> TestAnalysis::detected(const detect::LiveSettings& settings,
                                                           const Scans& scans) {
  detect::LiveDetector detector{settings};
  base::LongColumn<detect::LiveCycle> cycles{scans.scratch_folder};
  auto gap = scans.gaps.begin();
  for (std::size_t k = 0; k < scans.indices.size(); ++k) {
    for (; gap != scans.gaps.end() && gap->first <= scans.indices[k]; ++gap) detector.gap(gap->count);
    if (const auto cycle = detector.add(scans.coefficients[k], scans.saturated[k] != 0))
      cycles.push_back(*cycle);
  }
  for (; gap != scans.gaps.end(); ++gap) detector.gap(gap->count);
  if (const auto cycle = detector.end()) cycles.push_back(*cycle);
  return cycles;
}

void TestAnalysis::no_bootstrap(std::string reason) {
  if (settings_.bootstrap.count > 0)
    bootstrap_ = analysis::no_bootstrap(settings_.bootstrap, std::move(reason));
}

void TestAnalysis::speed_results(const estimate::Trace& trace, const TestEstimates& estimates,
                                 TestResults& results) const {
  if (!trace.belt.has_one_speed()) {
    results.pull_speed_measured = Estimate::none("the pull speed changes during the test");
    return;
  }
  if (!estimates.tester) {
    results.pull_speed_measured = Estimate::none(estimates.rung_reason);
    return;
  }
  const TesterEstimate& found = *estimates.tester;
  if (estimates.captured == 0 && may_never_have_stuck(found, results)) {
    void_start(found, settings_.tester.gravity_m_per_s2, results);
    if (!tester_check_) return;
    for (const base::Finding& finding : tester_check_->findings) {
      if (finding.code != base::kind_of(base::FindingCode::kPullSpeed).name)
        base::add(results.findings, finding);
    }
    return;
  }
  results.pull_speed_measured =
      tester_check_ ? tester_check_->pull_speed : pull_speed_of(found, settings_.tester.gravity_m_per_s2);
  if (results.pull_speed_measured.value) {
    // The stick rate that was fitted is less by that of the drift.
    const double omega0_squared =
        found.omega * found.omega * (1.0 + found.gamma_over_2omega * found.gamma_over_2omega);
    *results.pull_speed_measured.value +=
        trace.drift.rate_per_s * settings_.tester.gravity_m_per_s2 / omega0_squared;
  }
  if (tester_check_) {
    for (const base::Finding& finding : tester_check_->findings) base::add(results.findings, finding);
  } else if (auto finding = speed_finding(results.pull_speed_measured, settings_.tester)) {
    base::add(results.findings, *std::move(finding));
  }
}

void TestAnalysis::keep_cycles(const estimate::Trace& trace, const TestEstimates& estimates,
                               const base::LongColumn<detect::Fall>& slips,
                               const std::function<bool(const detect::Fall&)>& tells_delta_mu) {
  const base::LongColumn<detect::Cycle>& cycles = estimates.cycles;
  const base::LongColumn<double>& log_likelihood_ratios = estimates.log_likelihood_ratios;
  const base::LongColumn<base::ScanIndex>& indices = indices_;
  const base::LongColumn<std::uint8_t>& saturated = saturated_;
  cycles_ = base::LongColumn<detect::Cycle>{settings_.scratch_folder};
  LiveCycles live{trace, live_cycles_};
  const bool by_fit = fits_whole_test() && estimates.model_describes;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    detect::Cycle cycle = cycles[i];
    if (!tells_delta_mu(slips[i])) cycle.delta_mu = cycle.delta_mu_standard_error = base::kNaN;
    const auto first = static_cast<std::size_t>(std::lround(slips[i].peak_at));
    const auto end = i + 1 < slips.size() ? static_cast<std::size_t>(std::lround(slips[i + 1].peak_at))
                                          : static_cast<std::size_t>(std::lround(slips[i].trough_at));
    cycle.first_scan = indices[first];
    const base::ScanIndex last_scan = indices[std::min(end, indices.size() - 1)];
    // Spikes and gaps rise.
    const auto spike = std::lower_bound(spikes_.begin(), spikes_.end(), cycle.first_scan);
    if (spike != spikes_.end() && *spike < last_scan) cycle.flags |= detect::kCycleHasSpike;
    const auto gap =
        std::lower_bound(gaps_.begin(), gaps_.end(), cycle.first_scan,
                         [](const Gap& candidate, base::ScanIndex scan) { return candidate.first < scan; });
    if (gap != gaps_.end() && gap->first < last_scan) cycle.flags |= detect::kCycleHasGap;
    if (std::any_of(saturated.begin() + static_cast<std::ptrdiff_t>(first),
                    saturated.begin() + static_cast<std::ptrdiff_t>(std::min(end, saturated.size())),
                    [](std::uint8_t flag) { return flag != 0; })) {
      cycle.flags |= detect::kCycleIsSaturated;
    }
    if (measured_speed_ && std::isnan(cycle.pull_speed_m_per_s)) {
      // Without a fit the peak, which is near it, stands for the onset.
      const double at_s =
          by_fit || std::isfinite(cycle.onset_time_s) ? cycle.onset_time_s : cycle.peak_time_s;
      if (std::isfinite(at_s)) cycle.pull_speed_m_per_s = measured_speed_->speed_m_per_s(at_s);
    }
    if (fits_whole_test()) {
      if (i < log_likelihood_ratios.size() && log_likelihood_ratios[i] != 0.0)
        cycle.capture_evidence = log_likelihood_ratios[i];
      if (const auto seen = live.next_at(slips[i], cycle.period_s)) {
        cycle.live_capture_evidence = seen->cycle.live_capture_evidence;
        cycle.live_decision_time_s = seen->cycle.live_decision_time_s;
      }
    }
    cycles_.push_back(cycle);
  }
}

}  // namespace stickslip::analysis
