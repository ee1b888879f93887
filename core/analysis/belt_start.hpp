/// \file
/// When did the belt start? A plan tells the speed from then on, the trace only shows when force appears.
#pragma once

#include <optional>

#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"
#include "core/model/pull_speed.hpp"

namespace stickslip::analysis {

/// The plan over the time of the trace, laid so that the loading up to the first slip agrees with it: there
/// the force is r ∫p from the start on, r and the start being fitted to the middle of the loading by least
/// squares, about the mean of the scans before. A belt that starts with a jump to v leaves the sled behind
/// for v/(K g), which has the loading lag by half of that: it is taken off. Of 20 scans with a noise of 1/50
/// of S − K the start is known to 0.3 ms, on a ramp from 0.3 v_th by 2 mm/s² 0.03 % of the speed. \param
/// first  the first slip. \param gravity_m_per_s2 > 0 \return one speed throughout if the plan says so;
/// nothing if the trace does not hold the loading from rest.
[[nodiscard]] std::optional<model::BeltCourse> belt_from_loading(const estimate::Trace& trace,
                                                                 const detect::Fall& first,
                                                                 const model::PullSpeed& plan,
                                                                 double gravity_m_per_s2);

}  // namespace stickslip::analysis
