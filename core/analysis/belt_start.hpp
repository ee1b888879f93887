/// \file
/// Start time of the belt in a test whose speed changes. The plan gives the speed from the start of the belt
/// on; the loading in the trace tells when that was.
#pragma once

#include <optional>

#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// Belt speed over the time of the trace: the plan, shifted so that it agrees with the loading, the rise of
/// the force from rest to the first slip. A least-squares fit of coefficient = zero + rate × travel to the
/// scans between 20 and 80 % of the rise determines rate and start. Zero is the mean of the usable scans
/// up to 10 ms before the start; 0 if there are fewer than 16.
///
/// A belt that starts with a jump to v leaves the sled behind for v/(K g), and the loading lags by half of
/// that; the lag is subtracted. From 20 scans with noise of 1/50 of S − K the start has a standard error of
/// 0.3 ms. On a ramp from 0.3 v_th by 2 mm/s² that is 0.03 % of the speed.
/// \param trace  not empty.
/// \param first  the first slip.
/// \param gravity_m_per_s2 > 0.
/// \return constant_belt() if plan.is_constant(); nullopt if the rise to the first slip begins at half of its
///         peak or higher, fewer than four of the scans to be fitted are usable, they lie beyond the first
///         pull of the plan, or the fit fails.
[[nodiscard]] std::optional<model::BeltMotion> belt_from_loading(const estimate::Trace& trace,
                                                                 const detect::Fall& first,
                                                                 const model::PullSpeed& plan,
                                                                 double gravity_m_per_s2);

}  // namespace stickslip::analysis
