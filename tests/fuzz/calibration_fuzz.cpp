// Any text is a calibration of a load cell (or a characterisation of a tester) or is refused in one line;
// what is taken is written in a way that gives the same again.

#include <bit>
#include <cstdint>
#include <string_view>

#include "io/calibration_file.hpp"

#include "core/base/contract.hpp"
#include "core/record/tester_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stickslip;
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  const auto calibration = io::parse_calibration(text, "x.toml");
  STICKSLIP_EXPECTS(calibration || calibration.error().exit_status() == 2);
  STICKSLIP_EXPECTS(calibration || calibration.error().message.find('\n') == std::string::npos);
  if (calibration) {
    const auto again = io::parse_calibration(io::calibration_text(*calibration), "y.toml");
    STICKSLIP_EXPECTS(again);
    const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
    STICKSLIP_EXPECTS(bits(again->load_cell.gain_N_per_V) == bits(calibration->load_cell.gain_N_per_V));
    STICKSLIP_EXPECTS(bits(again->load_cell.zero_V) == bits(calibration->load_cell.zero_V));
    STICKSLIP_EXPECTS(again->facts.date == calibration->facts.date);
    STICKSLIP_EXPECTS(again->facts.mass_kg.size() == calibration->facts.mass_kg.size());
  }
  const auto tester = record::parse_tester(text, "x.toml");
  STICKSLIP_EXPECTS(tester || tester.error().exit_status() == 2);
  STICKSLIP_EXPECTS(tester || tester.error().message.find('\n') == std::string::npos);
  return 0;
}
