/// \file
/// What the scans of a test tell against the signal itself: an amplifier that clips, a frozen value,
/// coarse steps, a begin in mid-pull, a force that is no pull.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/analysis/pull_check.hpp"
#include "core/analysis/results.hpp"
#include "core/base/long_column.hpp"
#include "core/estimate/trace.hpp"
#include "core/signal/held_values.hpp"

namespace stickslip::analysis {

/// What check_signal() finds; each member is absent if it is not found. Of a highest value that is both
/// clipped and frozen only one is set.
struct SignalCheck {
  std::optional<signal::HeldValues> clipped;  ///< The highest level, where scans stay too often.
  std::optional<signal::HeldValues> frozen;   ///< The value that stood still.
  std::optional<double> coarse_noise;  ///< Noise of a scan in steps of the converter, where below a quarter.
  std::optional<double> begins_at;     ///< First value divided by the largest; set if it begins in mid-pull.
  std::optional<NoPull> no_pull;

  /// Whether the scans tell neither regime nor coefficients.
  [[nodiscard]] bool voids() const noexcept { return no_pull || held(); }
  /// The values that are no measurement: frozen ones, else clipped ones; absent without either.
  [[nodiscard]] const std::optional<signal::HeldValues>& held() const noexcept {
    return frozen ? frozen : clipped;
  }
};

/// \param trace  without spikes; scans at a rail are not usable.
/// \param measured  the same scans with their spikes: what replaces a spike lies on no step.
/// \param saturated  not 0 for a scan at a rail.
/// \param step_coefficient  one step of the converter; 0 if unknown, then it is found from `measured`.
[[nodiscard]] SignalCheck check_signal(const estimate::Trace& trace, const base::LongColumn<double>& measured,
                                       const base::LongColumn<std::uint8_t>& saturated,
                                       double step_coefficient, double scan_rate_Hz);

/// If check.voids(): removes regime, rung, all findings so far, and all estimates but the counts of spikes,
/// gaps and lost scans and the scan rate. A clipped pull also keeps its cycle count, period and frequency.
void void_results(const SignalCheck& check, TestResults& results);

/// Adds a finding for each member of `check` that is set. Call after void_results(), which removes findings.
void add_signal_findings(const SignalCheck& check, std::size_t scan_count, TestResults& results);

}  // namespace stickslip::analysis
