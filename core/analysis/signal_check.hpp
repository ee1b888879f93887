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

struct SignalCheck {
  std::optional<signal::HeldValues> clipped;
  std::optional<signal::HeldValues> frozen;
  std::optional<double> coarse_noise;  ///< Noise of a scan in steps, if it is too small.
  std::optional<double> begins_at;     ///< First scans over the largest, if they are in mid-pull.
  std::optional<NoPull> no_pull;

  /// Whether the scans tell neither regime nor coefficients.
  [[nodiscard]] bool voids() const noexcept { return no_pull || held(); }
  /// The values that are no measurement.
  [[nodiscard]] const std::optional<signal::HeldValues>& held() const noexcept {
    return frozen ? frozen : clipped;
  }
};

/// \param trace  without spikes; scans at a rail are not usable.
/// \param measured  its scans as they came: what replaces a spike lies on no step.
/// \param saturated  not 0 for a scan at a rail.
/// \param step_coefficient  of the converter; 0 if unknown.
[[nodiscard]] SignalCheck check_signal(const estimate::Trace& trace, const base::LongColumn<double>& measured,
                                       const base::LongColumn<std::uint8_t>& saturated,
                                       double step_coefficient, double scan_rate_Hz);

/// Takes away what the scans do not tell where values are held or nothing was pulled: regime and
/// coefficients, with the findings on them.
void void_results(const SignalCheck& check, TestResults& results);

void add_signal_findings(const SignalCheck& check, std::size_t scan_count, TestResults& results);

}  // namespace stickslip::analysis
