#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <utility>

#include "drivers/simulated/simulated_board.hpp"
#include "tests/conformance/board_case.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::test {

BoardCase simulated_case() {
  const auto make = [](ManualClock& clock) {
    const std::filesystem::path scenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes";
    auto tester = drivers::make_simulated_tester(
        {.scenes = {scenes / "ring-down-at-12-in-per-min.toml", scenes / "stick-slip-at-12-in-per-min.toml"},
         .repeats = 1,
         .scan_rate_Hz = {}},
        clock);
    if (!tester) throw std::runtime_error(tester.error().message);
    return BoardRig{nullptr, nullptr, std::move(tester->board)};
  };
  return {.name = "Simulated", .make = make};
}

BoardCase simulated_gaps_case() {
  const auto make = [](ManualClock& clock) {
    const std::filesystem::path scenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes";
    auto tester = drivers::make_simulated_tester(
        {.scenes = {scenes / "clock-and-missing-scans.toml"}, .repeats = 2, .scan_rate_Hz = {}}, clock);
    if (!tester) throw std::runtime_error(tester.error().message);
    return BoardRig{nullptr, nullptr, std::move(tester->board)};
  };
  return {.name = "SimulatedGaps", .make = make};
}

BoardCase simulated_speed_case() {
  const auto make = [](ManualClock& clock) {
    const std::filesystem::path scenes = std::filesystem::path(STICKSLIP_SOURCE_DIR) / "config/scenes";
    drivers::SimulatedBoardSettings settings;
    settings.scenes = {scenes / "speed-ramp.toml"};
    settings.speed_gain_m_per_s_per_V = 2e-3;
    auto tester = drivers::make_simulated_tester(settings, clock);
    if (!tester) throw std::runtime_error(tester.error().message);
    return BoardRig{nullptr, nullptr, std::move(tester->board)};
  };
  return {.name = "SimulatedWithSpeed", .make = make};
}

BoardCase simulated_hanging_case() {
  const auto make = [](ManualClock& clock) {
    const auto folder = std::make_shared<TemporaryFolder>();
    drivers::SimulatedBoardSettings settings;
    settings.scenes = {std::filesystem::path(STICKSLIP_SOURCE_DIR) /
                       "config/scenes/ring-down-at-12-in-per-min.toml"};
    settings.hanging = folder->path() / "hanging";
    std::ofstream{settings.hanging} << "0.5 0.01";
    auto tester = drivers::make_simulated_tester(settings, clock);
    if (!tester) throw std::runtime_error(tester.error().message);
    return BoardRig{folder, nullptr, std::move(tester->board)};
  };
  return {.name = "SimulatedHanging", .make = make};
}

}  // namespace stickslip::test
