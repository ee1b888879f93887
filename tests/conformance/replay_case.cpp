#include <utility>

#include "drivers/replay/replay_board.hpp"
#include "tests/conformance/board_case.hpp"

namespace stickslip::test {

namespace {

BoardCase recorded(const char* name, bool second) {
  const auto make = [second](ManualClock& clock) {
    constexpr daq::ScanIndex kFirst = 10'000;
    constexpr daq::ScanIndex kCount = 2'000;
    record::Record record;
    record.header.board.driver = "comedi";
    record.header.board.board_name = "recorded board";
    record.header.board.device = "/dev/comedi0";
    record.header.board.quantity = daq::RawQuantity::kCounts;
    record.header.board.maxdata = 65535;
    record.header.board.range_min_V = -10.0;
    record.header.board.range_max_V = 10.0;
    record.header.board.polynomial = {-10.0, 20.0 / 65535.0};
    record.header.board.scan_rate_requested_Hz = 350.0;
    record.header.board.scan_rate_granted_Hz = 1e9 / 2'857'000.0;
    for (daq::ScanIndex i = 0; i < kCount; ++i) {
      record.scan.push_back(kFirst + i);
      record.raw.push_back(static_cast<double>(i * 7919 % 65536));
      if (second) record.second.push_back(static_cast<std::int32_t>(i * 31 % 4096));
    }
    if (second) record.header.board.second.emplace().maxdata = 4095;
    drivers::Replay replay = drivers::make_replay(std::move(record), clock);
    return BoardRig{nullptr, nullptr, std::move(replay.board)};
  };
  return {.name = name, .make = make};
}

}  // namespace

BoardCase replay_case() { return recorded("Replay", false); }

BoardCase replay_second_case() { return recorded("ReplayWithSecond", true); }

}  // namespace stickslip::test
