/// \file
/// Capture: the time at which a slip becomes a stick. [Penner 1995, (20)–(22)]
#pragma once

#include <optional>

#include "core/model/belt_motion.hpp"
#include "core/model/slip_waveform.hpp"

namespace stickslip::model {

/// Capture time: the first time after the fastest slip at which c′ reaches the rate of the belt. It is the
/// root in [t₂, t₃], where c′ rises monotonically; t₂ if c′ is at or above the belt's rate there already. It
/// exists exactly when c′(t₃) ≥ belt rate; this closed form decides, not the root search.
/// \param slip  must oscillate.
/// \param belt_rate_per_s  ω₀² v/g; any sign.
/// \return seconds after the onset; nullopt if the sled is not captured.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept;

/// Capture time by Halley's steps from the capture time of a slightly different slip.
/// \param slip  must oscillate.
/// \param near_s  that capture time, seconds after the onset.
/// \return seconds after the onset; nullopt if six steps do not converge within a quarter of an oscillation
/// of near_s, or if they leave the rise of c′: capture_time_s() must then decide.
[[nodiscard]] std::optional<double> capture_time_near_s(const SlipWaveform& slip, double belt_rate_per_s,
                                                        double near_s) noexcept;

/// Capture time on a belt whose speed may change: where c′ rises to the belt's rate, between t₂ and
/// deciding_time_s(); t₂ if c′ is at or above the belt's rate at t₂ already. It exists exactly when c′ is at
/// or above the belt's rate at deciding_time_s(). The belt's rate is BeltMotion::stick_rate().
/// \param slip  must oscillate.
/// \param r  stick rate at the plan's largest speed, 1/s.
/// \param onset_s  time of the slip's onset, on the belt's time axis.
/// \return seconds after the onset; nullopt if the sled is not captured.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, const BeltMotion& belt, double r,
                                                   double onset_s) noexcept;

/// Time at which c′ − belt rate has its maximum near t₃, in seconds after the onset: its sign there decides
/// whether the sled is captured. t₃ on a constant belt. On an accelerating belt the maximum lies where c″
/// equals the slope r p′ of the belt's rate, p being BeltMotion::relative(). It is searched within a quarter
/// of an oscillation of t₃, which suffices while |r p′| < ω |c′(t₃)|; beyond that the result is t₃. A ramp
/// that reaches the threshold speed in a second has about a hundredth of that acceleration.
/// \param slip  must oscillate. The other parameters are those of capture_time_s().
[[nodiscard]] double deciding_time_s(const SlipWaveform& slip, const BeltMotion& belt, double r,
                                     double onset_s) noexcept;

}  // namespace stickslip::model
