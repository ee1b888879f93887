#include "core/analysis/live_estimates.hpp"

#include <algorithm>
#include <cmath>

#include "core/analysis/model_results.hpp"
#include "core/analysis/slip_windows.hpp"
#include "core/analysis/tier_means.hpp"
#include "core/base/nan.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Of a slip that the live side did not see: what the fall itself tells.
detect::Cycle row_of(const estimate::Trace& trace, const detect::Fall& slip) {
  detect::Cycle row;
  row.peak_time_s = estimate::time_at(trace, slip.peak_at);
  row.peak = slip.peak;
  row.trough = slip.trough;
  row.onset_time_s = row.capture_time_s = row.stick_time_s = row.slip_time_s = base::kNaN;
  row.delta_mu = row.delta_mu_standard_error = row.slip_speed_ratio = base::kNaN;
  return row;
}

/// How long the contact rested before slip i, which follows a hold. While it creeps the force falls on: the
/// fall before it takes no longer than the one before that.
double rest_of_hold_s(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                      std::size_t i, const detect::Cycle& row) {
  const auto s = [&trace](double scan) { return estimate::time_at(trace, scan); };
  const detect::Fall last = slips[i - 1];
  double trough_s = s(last.trough_at);
  double cycle_s = 0.0;
  if (i > 1) {
    const detect::Fall before = slips[i - 2];
    trough_s = std::min(trough_s, s(last.peak_at) + s(before.trough_at) - s(before.peak_at));
    cycle_s = s(last.peak_at) - s(before.peak_at);
  }
  const double onset_s = std::isfinite(row.onset_time_s) ? row.onset_time_s : row.peak_time_s;
  return onset_s - rests_from_s(trace, slips[i], trough_s, cycle_s);
}

/// How it ended is not known.
void forget_end(detect::Cycle& row) {
  row.flags &= static_cast<std::uint8_t>(~detect::kCycleCaptured);
  row.capture_evidence = row.capture_time_s = row.slip_time_s = base::kNaN;
}

}  // namespace

std::optional<detect::LiveCycle> LiveCycles::next_at(const detect::Fall& slip, double period_s) {
  if (next_ == cycles_->size()) return std::nullopt;
  const double peak_s = estimate::time_at(*trace_, slip.peak_at);
  const auto off_s = [&](std::size_t i) { return std::abs((*cycles_)[i].cycle.peak_time_s - peak_s); };
  double nearest_s = off_s(next_);
  for (; next_ + 1 < cycles_->size(); ++next_) {
    const double other_s = off_s(next_ + 1);
    if (other_s > nearest_s) break;
    nearest_s = other_s;
  }
  // Without a next slip: a fall is half an oscillation.
  const double reach_s =
      std::isnan(period_s) ? estimate::time_at(*trace_, slip.trough_at) - peak_s : 0.5 * period_s;
  if (!(nearest_s < reach_s)) return std::nullopt;
  return (*cycles_)[next_++];
}

TestEstimates estimates_from_live(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                                  const base::LongColumn<detect::LiveCycle>& live,
                                  const LiveSettlement& settlement, const std::filesystem::path& scratch) {
  TestEstimates whole;
  whole.log_likelihood_ratios = base::LongColumn<double>{scratch};
  whole.cycles = base::LongColumn<detect::Cycle>{scratch};
  whole.onset_errors_s = base::LongColumn<double>{scratch};
  no_model_results(settlement.reason, whole.results);

  LiveCycles seen{trace, live};
  TierMeans means{settlement.first_counts};
  signal::RunningVariance amplitude;
  std::optional<detect::Cycle> before;  // Its period reaches to the row that comes next.
  const auto keep = [&](double period_s) {
    before->period_s = period_s;
    before->force_drop = before->peak - before->trough;
    if ((before->flags & detect::kCycleCaptured) != 0) ++whole.captured;
    whole.cycles.push_back(*before);
    whole.onset_errors_s.push_back(base::kNaN);
  };
  bool is_next = false;  // Nothing is missing between it and the one before.
  const auto held = [&](std::size_t i) { return i > 0 && is_held_between(trace, slips[i - 1], slips[i]); };
  bool all_are_held = true;
  for (std::size_t i = 1; all_are_held && i < slips.size(); ++i) all_are_held = held(i);
  bool after_gap = false;  // How the one before ended, and when, was not seen.
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const detect::Fall slip = slips[i];
    const bool is_last = i + 1 == slips.size();
    const bool is_slack = !is_last && settlement.slack.holds(trace, slip);
    const bool is_held = held(i);
    const bool counts = !is_slack && (!is_held || settlement.first_counts || all_are_held);
    const bool has_next = !is_last && !estimate::is_broken(trace, slip.peak_at, slips[i + 1].peak_at);
    detect::Cycle row = row_of(trace, slip);
    const double period_s =
        has_next ? estimate::time_at(trace, slips[i + 1].peak_at) - row.peak_time_s : base::kNaN;
    bool has_gap = !has_next;
    if (const std::optional<detect::LiveCycle> cycle = seen.next_at(slip, period_s)) {
      row = cycle->cycle;
      // Also of one that was not decided: what hardly speaks against sticking leaves the regime undecided.
      row.capture_evidence = cycle->evidence;
      has_gap = has_gap || (row.flags & detect::kCycleHasGap) != 0;
      if (counts) means.add(*cycle);
    }
    if (has_gap || after_gap) forget_end(row);
    after_gap = has_gap;
    row.number = static_cast<std::int64_t>(i);
    row.flags &= detect::kCycleCaptured;
    if (i == 0 || is_held) row.flags |= detect::kCycleIsFirst;
    if (is_held) row.stick_time_s = rest_of_hold_s(trace, slips, i, row);
    if (!trace.belt.is_constant()) {
      const double at_s = std::isfinite(row.onset_time_s) ? row.onset_time_s : row.peak_time_s;
      row.pull_speed_m_per_s = trace.belt.plan().speed_m_per_s(at_s - trace.belt.start_s());
    }
    if (!is_last) {
      const bool tells = std::isfinite(row.capture_evidence);
      whole.log_likelihood_ratios.push_back(tells ? row.capture_evidence : 0.0);
    }
    if (before) keep(is_next ? row.peak_time_s - before->peak_time_s : base::kNaN);
    before = row;
    is_next = has_next;
    if (counts) means.add_level(slip.peak, slip.trough);
    amplitude.add(0.5 * slip.drop());
  }
  keep(base::kNaN);
  whole.results.amplitude = Estimate::of(amplitude.mean, amplitude.error_of_mean());
  means.fill(whole.results);
  return whole;
}

}  // namespace stickslip::analysis
