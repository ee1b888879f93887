/// \file
/// Capture: the time at which a slip becomes a stick. [Penner 1995, (20)–(22)]
#pragma once

#include <optional>

#include "core/model/belt_motion.hpp"
#include "core/model/slip_waveform.hpp"

namespace stickslip::model {

/// Capture time: the first time after the fastest slip at which c′ reaches the rate of the belt. It is the
/// root in [t₂, t₃], where c′ rises monotonically. It exists exactly when c′(t₃) ≥ belt rate; this closed
/// form decides, not the root search.
/// \param slip  must oscillate.
/// \param belt_rate_per_s  ω₀² v/g.
/// \return seconds after the onset; nullopt if the sled is not captured.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept;

/// Capture time by Halley's steps from the capture time of a slightly different slip.
/// \param near_s  that capture time, seconds after the onset.
/// \return nullopt if six steps do not converge within a quarter of an oscillation of near_s.
[[nodiscard]] std::optional<double> capture_time_near_s(const SlipWaveform& slip, double belt_rate_per_s,
                                                        double near_s) noexcept;

/// Capture time on a belt whose speed may change: where c′ rises to the belt's rate, between t₂ and the
/// maximum of c′ − belt rate near t₃; t₂ if c′ is not below the belt's rate there. It exists exactly when
/// that maximum is not negative. A steady acceleration moves that maximum from t₃ to where c″ equals the
/// slope of the belt's rate. The maximum is searched within a quarter of an oscillation of t₃; this suffices
/// while |r p′| < ω |c′|, 100 times the acceleration of a ramp that reaches the threshold speed in a second.
/// \param r  stick rate at the plan's largest speed; p is BeltMotion::relative().
/// \param onset_s  time of the slip's onset, on the belt's time axis.
/// \return seconds after the onset; nullopt if the sled is not captured.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, const BeltMotion& belt, double r,
                                                   double onset_s) noexcept;

/// Time at which c′ − belt rate has its maximum near t₃, in seconds after the onset: its sign there decides
/// whether the sled is captured. Equal to t₃ with one speed throughout.
[[nodiscard]] double deciding_time_s(const SlipWaveform& slip, const BeltMotion& belt, double r,
                                     double onset_s) noexcept;

}  // namespace stickslip::model
