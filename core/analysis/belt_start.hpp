/// \file
/// Start time of the belt, from the loading: a plan gives the speed from the start on, the trace only the
/// force.
#pragma once

#include <optional>

#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// Belt speed over the time of the trace: the plan, shifted so that it agrees with the loading up to the
/// first slip. The loading is r ∫p from the start on, above the mean of the scans before. Least squares over
/// its middle determine r and the start. A belt that starts with a jump to v leaves the sled behind for v/(K
/// g), and the loading lags by half of that; the lag is subtracted. From 20 scans with noise of 1/50 of S − K
/// the start has a standard error of 0.3 ms, which on a ramp from 0.3 v_th by 2 mm/s² is 0.03 % of the speed.
/// \param first  the first slip.
/// \param gravity_m_per_s2 > 0.
/// \return constant_belt() if the plan has one speed; nullopt if the trace does not contain the loading from
/// rest, the loading has fewer than four usable scans or lies beyond the first pull of the plan, or the fit
/// fails.
[[nodiscard]] std::optional<model::BeltMotion> belt_from_loading(const estimate::Trace& trace,
                                                                 const detect::Fall& first,
                                                                 const model::PullSpeed& plan,
                                                                 double gravity_m_per_s2);

}  // namespace stickslip::analysis
