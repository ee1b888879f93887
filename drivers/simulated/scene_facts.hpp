/// \file
/// Board, load cell and tester of a bench that plays scenes. Properties that all scenes must share are taken
/// from the first.
#pragma once

#include <optional>
#include <vector>

#include "core/daq/board.hpp"
#include "core/daq/calibration.hpp"
#include "core/model/tester.hpp"
#include "core/sim/scene.hpp"

namespace stickslip::drivers {

/// \param scenes  at least one.
/// \param speed_gain_m_per_s_per_V  of the second input; absent: there is none. Needs a converter in the
/// scenes.
[[nodiscard]] daq::BoardInfo board_info_of(const std::vector<sim::Scene>& scenes, double scan_rate_Hz,
                                           std::optional<double> speed_gain_m_per_s_per_V = {});

[[nodiscard]] daq::LoadCell load_cell_of(const sim::Scene& scene);

/// Mass and gravity; the pull speed, or its course, if it is the same in all scenes.
/// \param scenes  at least one.
[[nodiscard]] model::Tester tester_of(const std::vector<sim::Scene>& scenes);

}  // namespace stickslip::drivers
