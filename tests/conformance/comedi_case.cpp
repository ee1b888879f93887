#include <stdexcept>
#include <utility>

#include "drivers/comedi/comedi_board.hpp"
#include "tests/conformance/board_case.hpp"
#include "tests/support/fake_comedi.hpp"

namespace stickslip::test {

namespace {

BoardCase fake_case(const char* name, const drivers::ComediBoardSettings& settings) {
  const auto make = [settings](ManualClock& clock) {
    auto world = std::make_shared<FakeComediWorld>();
    auto board = drivers::make_comedi_board(settings, clock, std::make_unique<FakeComedi>(*world, clock));
    if (!board) throw std::runtime_error(board.error().message);
    return BoardRig{std::move(world), nullptr, std::move(*board)};
  };
  return {.name = name, .make = make};
}

}  // namespace

BoardCase comedi_case() { return fake_case("ComediOnAFakeTable", {}); }

BoardCase polled_comedi_case() {
  drivers::ComediBoardSettings settings;
  settings.acquisition = drivers::AcquisitionMode::kPolled;
  return fake_case("PolledComediOnAFakeTable", settings);
}

BoardCase comedi_second_case() {
  drivers::ComediBoardSettings settings;
  settings.second.emplace();
  return fake_case("ComediWithSecondOnAFakeTable", settings);
}

BoardCase polled_comedi_second_case() {
  drivers::ComediBoardSettings settings;
  settings.acquisition = drivers::AcquisitionMode::kPolled;
  settings.second.emplace();
  return fake_case("PolledComediWithSecondOnAFakeTable", settings);
}

}  // namespace stickslip::test
