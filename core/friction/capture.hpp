/// \file
/// When does the sled stick again? [Penner 1995, (20)–(22)]
#pragma once

#include <optional>

#include "core/friction/slip_waveform.hpp"

namespace stickslip::friction {

/// First time after the fastest slip at which c′ reaches the rate of the belt: the root in
/// [t₂, t₃], where c′ rises monotonically. It exists exactly when c′(t₃) ≥ belt rate; that closed
/// form decides, never a step past it.
/// \param slip  oscillates. \param belt_rate_per_s  ω₀² v/g.
/// \return seconds after the onset; nothing if the sled does not stick again.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept;

}  // namespace stickslip::friction
