#include <stdexcept>
#include <utility>

#include "drivers/comedi/comedi_board.hpp"
#include "tests/conformance/board_case.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {

BoardCase comedi_case() {
  const auto make = [](ManualClock& clock) {
    auto world = std::make_shared<FakeComediWorld>();
    auto board = drivers::make_comedi_board({}, clock, std::make_unique<FakeComedi>(*world, clock));
    if (!board) throw std::runtime_error(board.error().message);
    return BoardRig{std::move(world), nullptr, std::move(*board)};
  };
  return {.name = "ComediOnAFakeTable", .make = make};
}

BoardCase polled_comedi_case() {
  const auto make = [](ManualClock& clock) {
    auto world = std::make_shared<FakeComediWorld>();
    drivers::ComediBoardSettings settings;
    settings.acquisition = drivers::AcquisitionMode::kPolled;
    auto board = drivers::make_comedi_board(settings, clock, std::make_unique<FakeComedi>(*world, clock));
    if (!board) throw std::runtime_error(board.error().message);
    return BoardRig{std::move(world), std::move(*board)};
  };
  return {"PolledComediOnAFakeTable", make};
}

}  // namespace stickslip::test
