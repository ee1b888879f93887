#include "core/friction/live_estimates.hpp"

#include <cmath>

#include "core/friction/model_results.hpp"
#include "core/friction/unknown.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::friction {
namespace {

/// Of a slip that the live side did not see: what the fall itself tells.
Cycle row_of(const Trace& trace, const Fall& slip, double period_s) {
  Cycle row;
  row.peak_time_s = time_at(trace, slip.peak_at);
  row.period_s = period_s;
  row.peak = slip.peak;
  row.trough = slip.trough;
  row.force_drop = slip.drop();
  row.onset_time_s = row.capture_time_s = row.stick_time_s = row.slip_time_s = kNotKnown;
  row.delta_mu = row.delta_mu_standard_error = row.slip_speed_ratio = kNotKnown;
  return row;
}

}  // namespace

std::optional<Cycle> LiveCycles::next_at(const Fall& slip, double period_s) {
  if (next_ == cycles_->size()) return std::nullopt;
  const double peak_s = time_at(*trace_, slip.peak_at);
  const auto off_s = [&](std::size_t i) { return std::abs((*cycles_)[i].peak_time_s - peak_s); };
  while (next_ + 1 < cycles_->size() && off_s(next_ + 1) <= off_s(next_)) ++next_;
  // Without a next slip: a fall is half an oscillation.
  const double reach_s = std::isnan(period_s) ? time_at(*trace_, slip.trough_at) - peak_s : 0.5 * period_s;
  if (!(off_s(next_) < reach_s)) return std::nullopt;
  return (*cycles_)[next_++];
}

TestEstimates estimates_from_live(const Trace& trace, const base::LongColumn<Fall>& slips,
                                  const base::LongColumn<Cycle>& live, bool describes,
                                  const std::string& reason, const std::filesystem::path& scratch) {
  TestEstimates whole;
  whole.log_likelihood_ratios = base::LongColumn<double>{scratch};
  whole.cycles = base::LongColumn<Cycle>{scratch};
  whole.onset_errors_s = base::LongColumn<double>{scratch};
  whole.model_describes = describes;
  no_model_results(reason, whole.results);

  LiveCycles seen{trace, live};
  signal::RunningVariance amplitude;
  for (std::size_t i = 0; i < slips.size(); ++i) {
    const Fall slip = slips[i];
    const bool is_last = i + 1 == slips.size();
    const bool has_next = !is_last && !is_broken(trace, slip.peak_at, slips[i + 1].peak_at);
    const double period_s =
        has_next ? time_at(trace, slips[i + 1].peak_at) - time_at(trace, slip.peak_at) : kNotKnown;
    Cycle row = row_of(trace, slip, period_s);
    if (const std::optional<Cycle> cycle = seen.next_at(slip, period_s)) row = *cycle;
    row.number = static_cast<std::int64_t>(i);
    row.period_s = period_s;
    row.flags &= kCycleCaptured;
    if (i == 0) row.flags |= kCycleIsFirst;
    if ((row.flags & kCycleCaptured) != 0) ++whole.captured;
    if (!is_last) {
      const bool tells = std::isfinite(row.capture_evidence);
      whole.log_likelihood_ratios.push_back(tells ? row.capture_evidence : 0.0);
    }
    whole.onset_errors_s.push_back(kNotKnown);
    whole.cycles.push_back(row);
    amplitude.add(0.5 * slip.drop());
  }
  whole.results.amplitude = Estimate::of(amplitude.mean, amplitude.error_of_mean());
  return whole;
}

}  // namespace stickslip::friction
