/// \file
/// When does the sled stick again? [Penner 1995, (20)–(22)]
#pragma once

#include <optional>

#include "core/model/belt_course.hpp"
#include "core/model/slip_waveform.hpp"

namespace stickslip::model {

/// First time after the fastest slip at which c′ reaches the rate of the belt: the root in
/// [t₂, t₃], where c′ rises monotonically. It exists exactly when c′(t₃) ≥ belt rate; that closed
/// form decides, never a step past it.
/// \param slip  oscillates. \param belt_rate_per_s  ω₀² v/g.
/// \return seconds after the onset; nothing if the sled does not stick again.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, double belt_rate_per_s) noexcept;

/// The same where the capture of a course that differs a little is known: nothing where it is not found
/// within a quarter of an oscillation of that, by steps that only it can end. \param near_s  of that capture.
[[nodiscard]] std::optional<double> capture_time_near_s(const SlipWaveform& slip, double belt_rate_per_s,
                                                        double near_s) noexcept;

/// The same on a belt whose speed may change: the last upward crossing of c′ and the belt's rate about t₃. It
/// exists exactly when c′ less the rate is not negative at its maximum, which a steady acceleration moves
/// from t₃ to where c″ is the slope of the rate; that is looked for within a quarter of an oscillation of t₃,
/// which is enough while |r p′| < ω |c′| of the slip, or 100 times a ramp through the threshold speed in a
/// second. \param r  stick rate at the belt's reference speed. \param onset_s  time of the slip's onset.
[[nodiscard]] std::optional<double> capture_time_s(const SlipWaveform& slip, const BeltCourse& belt, double r,
                                                   double onset_s) noexcept;

/// Where c′ less the belt's rate is largest about the end of the rise of c′: there it is decided whether the
/// sled sticks again. t₃ with one speed throughout. Seconds after the onset.
[[nodiscard]] double deciding_time_s(const SlipWaveform& slip, const BeltCourse& belt, double r,
                                     double onset_s) noexcept;

}  // namespace stickslip::model
