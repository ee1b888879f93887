/// \file
/// The scalar results of one test. Each has one name in HDF5, JSON, tables and messages.
///
///     for_each_result(results, [](const ResultName& name, const Estimate& estimate) { … });
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/analysis/rung.hpp"
#include "core/analysis/uncertainty_part.hpp"
#include "core/base/finding.hpp"
#include "core/model/regime.hpp"

namespace stickslip::analysis {

/// A value with its uncertainties, or the reason why it is absent. Before it is filled it has neither.
struct Estimate {
  std::optional<double> value;
  std::optional<double> standard_error;          ///< Random: decreases with replicates.
  std::optional<double> systematic_uncertainty;  ///< Replicates do not decrease it; UncertaintySource.
  std::string reason;                            ///< Why there is no value; empty if there is one.
  SystematicParts systematic_parts{};            ///< What makes the systematic uncertainty, as far as known.

  /// Without a standard error. Absent if the number is not finite.
  [[nodiscard]] static Estimate of(double number) {
    if (!std::isfinite(number)) return none("not finite");
    return {number, {}, {}, {}};
  }
  /// Absent if the number is not finite; without a standard error if that is not.
  [[nodiscard]] static Estimate of(double number, double error) {
    if (!std::isfinite(number)) return none("not finite");
    return {number, std::isfinite(error) ? std::optional<double>{error} : std::nullopt, {}, {}};
  }
  [[nodiscard]] static Estimate none(std::string why) { return {{}, {}, {}, std::move(why)}; }

  bool operator==(const Estimate&) const = default;
};

/// Name, unit and description of a result.
struct ResultName {
  std::string_view name;
  std::string_view unit;       ///< SI, "1" for a ratio or a count.
  std::string_view long_name;  ///< For axes and tables.
  bool is_diagnostic = false;  ///< Another way to a quantity that has a result of its own.
};

/// Reason why Q and slip_speed_ratio_threshold are absent where the belt had several speeds.
inline constexpr std::string_view kSpeedChanges = "the pull speed changes";

/// Results of one test. Symbols as in docs/glossary.md.
struct TestResults {
  model::Regime regime = model::Regime::kUndecided;
  std::string regime_reason;  ///< What decided the regime; text for the user.
  Rung rung = Rung::kNone;    ///< Where S, K and S − K come from.
  std::string rung_reason;    ///< Why not a higher rung; empty on the highest. Text for the user.
  /// Part of the slip with the largest residuals, "rise", "peak", "fall" or "trough"; empty if there is no
  /// Misfit::place().
  std::string misfit_place;

  /// s after the record's first scan, only for mixed: onset of the first slip that ended otherwise than the
  /// last before it that tells, or its peak if the onset is not known.
  Estimate transition_time;
  Estimate cycle_count;  ///< Falls that are slips.
  /// Slips that ended in sticking, of those that tell how they ended. 0 in a regime that never sticks. Absent
  /// if undecided, if only the shape of the cycles tells stick-slip, or if slips stuck but fewer than half of
  /// all tell how they ended. The last never tells, but is taken for one that does in this rule.
  Estimate stick_cycle_count;
  Estimate period_median;          ///< s, from peak to peak.
  Estimate oscillation_frequency;  ///< Hz, cycles over time; ω/2π of a ring-down with a fit.
  Estimate static_coefficient;     ///< Traditional, by the method; absent if the trace begins under load.
  Estimate kinetic_coefficient;    ///< Traditional, by the method.
  Estimate mu_s;       ///< S of the model, by `rung`: mean over the slips, as a rule without the first.
  Estimate mu_k;       ///< K of the model, by `rung`: mean over the slips, as a rule without the first.
  Estimate delta_mu;   ///< S − K; half of its bound where it is not told from 0: tell_bound().
  Estimate amplitude;  ///< Half the mean range of the oscillation, coefficient.
  Estimate gamma_over_2omega;
  Estimate omega;  ///< rad/s, damped.
  Estimate Q;      ///< Dimensionless speed.
  Estimate Q_threshold;
  Estimate threshold_speed;   ///< m/s
  Estimate drift_rate;        ///< 1/s, of the mean coefficient.
  Estimate delta_mu_scatter;  ///< Standard deviation of S − K from cycle to cycle.
  Estimate spike_count;
  Estimate gap_count;
  Estimate lost_scan_count;
  Estimate scan_rate_measured;  ///< Hz, from clocks.
  /// m/s, where the pull speed changes, as in holds: that at the onset of the first slip that did not stick
  /// again.
  Estimate escape_speed;
  /// m/s, where the pull speed changes, as in holds: threshold speed for the mean S − K, from slips whose end
  /// is known.
  Estimate escape_speed_corrected;

  // From features of the cycles that stick, core/analysis/cycle_features.
  Estimate delta_mu_from_amplitude;     ///< S − K by the amplitude ratio [17].
  Estimate delta_mu_from_timing;        ///< S − K by the period.
  Estimate delta_mu_from_slip_speed;    ///< S − K by the slip-to-stick speed ratio [18].
  Estimate delta_mu_combined;           ///< Mean of these three, by condition number and scatter.
  Estimate mu_k_from_mean;              ///< K: the mean, corrected for the bias by damping.
  Estimate mu_s_from_amplitude;         ///< S: mu_k_from_mean + delta_mu_from_amplitude.
  Estimate pull_speed_measured;         ///< m/s, from the stick rate and ω₀.
  Estimate slip_speed_ratio_threshold;  ///< Ratio [18] from which on a slip ends in sticking: e^(πγ/2ω).

  Estimate mu_slope;  ///< s/m, μ′ = ∂μ_k/∂v, relative to the paper of the tester's characterisation.
  /// Systematic residual of the fit, in standard deviations of the scan noise, 0 for noise alone:
  /// √(residual² − 1), or what certainly repeats in each slip if that is more.
  Estimate misfit;
  Estimate smallest_slip;  ///< Smallest drop that would have been counted as a slip; coefficient.

  std::vector<base::Finding> findings;  ///< The most severe first; filled by base::add().

  bool operator==(const TestResults&) const = default;
};

/// Visits all estimates in the order of the record; `results` may be const or not.
/// \param visit  called as visit(ResultName, Estimate&).
template <typename Results, typename Visitor>
void for_each_result(Results& results, Visitor&& visit) {
  visit(ResultName{"transition_time", "s", "time of the transition between regimes"},
        results.transition_time);
  visit(ResultName{"cycle_count", "1", "number of slips"}, results.cycle_count);
  visit(ResultName{"stick_cycle_count", "1", "number of slips that ended in sticking"},
        results.stick_cycle_count);
  visit(ResultName{"period_median", "s", "median period"}, results.period_median);
  visit(ResultName{"oscillation_frequency", "Hz", "frequency of the oscillation"},
        results.oscillation_frequency);
  visit(ResultName{"static_coefficient", "1", "static coefficient, traditional rule"},
        results.static_coefficient);
  visit(ResultName{"kinetic_coefficient", "1", "kinetic coefficient, traditional rule"},
        results.kinetic_coefficient);
  visit(ResultName{"mu_s", "1", "static coefficient S of the model"}, results.mu_s);
  visit(ResultName{"mu_k", "1", "kinetic coefficient K of the model"}, results.mu_k);
  visit(ResultName{"delta_mu", "1", "S - K of the model"}, results.delta_mu);
  visit(ResultName{"amplitude", "1", "half the range of the oscillation"}, results.amplitude);
  visit(ResultName{"gamma_over_2omega", "1", "damping of the tester, gamma/(2 omega)"},
        results.gamma_over_2omega);
  visit(ResultName{"omega", "rad/s", "angular frequency of the damped oscillator"}, results.omega);
  visit(ResultName{"Q", "1", "dimensionless sled speed"}, results.Q);
  visit(ResultName{"Q_threshold", "1", "dimensionless speed above which the sled does not stick again"},
        results.Q_threshold);
  visit(ResultName{"threshold_speed", "m/s", "speed above which the sled does not stick again"},
        results.threshold_speed);
  visit(ResultName{"drift_rate", "1/s", "drift of the mean coefficient"}, results.drift_rate);
  visit(ResultName{"delta_mu_scatter", "1", "standard deviation of S - K from cycle to cycle"},
        results.delta_mu_scatter);
  visit(ResultName{"spike_count", "1", "number of spikes"}, results.spike_count);
  visit(ResultName{"gap_count", "1", "number of gaps"}, results.gap_count);
  visit(ResultName{"lost_scan_count", "1", "number of scans lost in gaps"}, results.lost_scan_count);
  visit(ResultName{"scan_rate_measured", "Hz", "scan rate measured against the clock"},
        results.scan_rate_measured);
  visit(ResultName{"escape_speed", "m/s", "pull speed at the first slip that did not stick again"},
        results.escape_speed);
  visit(ResultName{"escape_speed_corrected", "m/s",
                   "escape speed, corrected for being the first of many cycles"},
        results.escape_speed_corrected);
  visit(ResultName{"delta_mu_from_amplitude", "1", "S - K from the amplitude", true},
        results.delta_mu_from_amplitude);
  visit(ResultName{"delta_mu_from_timing", "1", "S - K from the period", true}, results.delta_mu_from_timing);
  visit(ResultName{"delta_mu_from_slip_speed", "1", "S - K from the largest slip speed", true},
        results.delta_mu_from_slip_speed);
  visit(ResultName{"delta_mu_combined", "1", "S - K from amplitude, period and slip speed", true},
        results.delta_mu_combined);
  visit(ResultName{"mu_k_from_mean", "1", "K from the mean, without the bias of the damping", true},
        results.mu_k_from_mean);
  visit(ResultName{"mu_s_from_amplitude", "1", "S from mean and amplitude", true},
        results.mu_s_from_amplitude);
  visit(ResultName{"pull_speed_measured", "m/s", "pull speed from the slope of the sticks"},
        results.pull_speed_measured);
  visit(ResultName{"slip_speed_ratio_threshold", "1",
                   "largest slip speed over drive speed from which on a slip ends in sticking"},
        results.slip_speed_ratio_threshold);
  visit(ResultName{"mu_slope", "s/m", "slope of the kinetic coefficient with speed, mu'"}, results.mu_slope);
  visit(ResultName{"misfit", "1", "systematic residual of the fit over the scan noise"}, results.misfit);
  visit(ResultName{"smallest_slip", "1", "smallest drop of the force that would have been counted"},
        results.smallest_slip);
}

}  // namespace stickslip::analysis
