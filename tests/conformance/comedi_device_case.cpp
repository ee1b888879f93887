#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/comedi/comedi_board.hpp"
#include "tests/conformance/board_case.hpp"

namespace stickslip::test {

namespace {

std::optional<BoardCase> device_case(const char* name, bool second) {
  using namespace std::chrono_literals;
  const char* device = std::getenv("STICKSLIP_COMEDI_DEVICE");
  if (device == nullptr) return std::nullopt;
  const auto make = [device = std::string(device), second](ManualClock& /*not for hardware*/) {
    std::shared_ptr<base::Clock> clock = base::make_system_clock();
    drivers::ComediBoardSettings settings;
    settings.device = device;
    if (second) settings.second.emplace();
    auto board = drivers::make_comedi_board(settings, *clock);
    if (!board) throw std::runtime_error(board.error().message);
    return BoardRig{nullptr, std::move(clock), std::move(*board)};
  };
  // poll() counts in whole ms, and a woken thread waits at most for the next tick of a 250 Hz kernel: 5 ms;
  // twice that, since a test may sleep twice.
  return BoardCase{.name = name,
                   .make = make,
                   .lateness = 10ms,
                   .input_repeats = std::getenv("STICKSLIP_COMEDI_REPEATS") != nullptr};
}

}  // namespace

std::optional<BoardCase> comedi_device_case() { return device_case("ComediOnTheKernel", false); }

std::optional<BoardCase> comedi_device_second_case() {
  if (std::getenv("STICKSLIP_COMEDI_SECOND") == nullptr) return std::nullopt;
  return device_case("ComediWithSecondOnTheKernel", true);
}

}  // namespace stickslip::test
