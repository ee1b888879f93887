/// \file
/// The simulated tester behind the board interface.
///
///     auto tester = drivers::make_simulated_tester({{"ring-down.toml", "stick-slip.toml"}, 5}, *clock);
///     if (!tester) return tl::unexpected(tester.error());
///     tester->board->start();
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/rate_meter.hpp"
#include "core/model/method.hpp"
#include "core/model/tester.hpp"
#include "core/model/truth.hpp"
#include "drivers/simulated/simulated_faults.hpp"

namespace stickslip::drivers {

struct SimulatedBoardSettings {
  std::vector<std::filesystem::path> scenes;  ///< Played in this order.
  int repeats = 1;  ///< Repetitions of each scene in a row; 0: the list is repeated without end.
  std::optional<double> scan_rate_Hz;  ///< Else that of the scenes. Granted as asked.
  model::Method method{};              ///< By which the truth reads the traditional coefficients.
  /// A second input reads the belt's speed through a converter like the force's, this much for each volt, not
  /// 0; absent: there is none.
  std::optional<double> speed_gain_m_per_s_per_V{};
  /// Says which weight hangs on the load cell in the place of the scene's force (HangingWeight); empty: none.
  std::filesystem::path hanging{};
  SimulatedFaults faults{};
  /// Index of the first scan, ≥ 0: as of a board that has been running since index 0.
  base::ScanIndex first_scan = 0;
  /// State of an earlier board that was unplugged; the index continues from it by the clock.
  std::optional<daq::Continuation> continues{};
};

/// Board and truth source made from one list of scenes, with the load cell and the tester that a real bench
/// would have documented.
struct SimulatedTester {
  std::unique_ptr<daq::Board> board;
  std::shared_ptr<const model::TruthSource> truth;
  daq::LoadCell load_cell;
  /// Mass and gravity; the pull speed if it is the same in all scenes.
  model::Tester tester;
};

/// \param clock  paces the board: scan i after a start is due (i + 1)/rate later. Outlives it. A read waits
/// for the scans of 40 ms, as many as come in time.
///
/// The board waits while it is stopped: after the next start it goes on with the next scan.
/// Usage error: a scene that cannot be read, no scene, negative repeats or first scan, rate not positive,
/// a speed to be read but no converter in the scenes, scenes that disagree about tester, load cell, converter
/// or (unless one is asked for) scan rate.
[[nodiscard]] base::Result<SimulatedTester> make_simulated_tester(const SimulatedBoardSettings& settings,
                                                                  base::Clock& clock);

}  // namespace stickslip::drivers
