#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

#include "drivers/comedi/comedi_board.hpp"
#include "tests/conformance/board_case.hpp"

namespace stickslip::test {

std::optional<BoardCase> comedi_device_case() {
  using namespace std::chrono_literals;
  const char* device = std::getenv("STICKSLIP_COMEDI_DEVICE");
  if (device == nullptr) return std::nullopt;
  const auto make = [device = std::string(device)](ManualClock& /*not for hardware*/) {
    std::shared_ptr<base::Clock> clock = base::make_system_clock();
    drivers::ComediBoardSettings settings;
    settings.device = device;
    auto board = drivers::make_comedi_board(settings, *clock);
    if (!board) throw std::runtime_error(board.error().message);
    return BoardRig{nullptr, std::move(clock), std::move(*board)};
  };
  // poll() counts in whole ms, and a woken thread waits at most for the next tick of a 250 Hz kernel: 5 ms;
  // twice that, since a test may sleep twice.
  return BoardCase{.name = "ComediOnTheKernel",
                   .make = make,
                   .lateness = 10ms,
                   .input_repeats = std::getenv("STICKSLIP_COMEDI_REPEATS") != nullptr};
}

}  // namespace stickslip::test
