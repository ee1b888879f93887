#include "drivers/comedi/board_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "drivers/comedi/comedi_agreement.hpp"
#include "drivers/comedi/comedi_errors.hpp"
#include "drivers/comedi/comedi_setup.hpp"

namespace stickslip::drivers {
namespace {

std::string type_name(int type) {
  // COMEDI_SUBD_… in order.
  static constexpr std::array kNames{
      "unused",  "analog input", "analog output", "digital input", "digital output", "digital in/out",
      "counter", "timer",        "memory",        "calibration",   "processor",      "serial",
      "pwm"};
  const auto number = static_cast<std::size_t>(std::max(type, 0));
  return number < kNames.size() ? kNames.at(number) : "other";
}

/// The rate that the board grants when asked for one far out of its range.
std::optional<double> rate_at(double asked_Hz, const std::string& device, unsigned subdevice,
                              ComediCalls& calls) {
  ComediBoardSettings settings;
  settings.device = device;
  settings.scan_rate_Hz = asked_Hz;
  settings.scan_rate_tolerance = std::numeric_limits<double>::infinity();
  const auto agreed = agree_on_command(settings, subdevice, 0, calls);
  return agreed ? std::optional{agreed->scan_rate_Hz} : std::nullopt;
}

SubdeviceOffer survey_subdevice(unsigned number, const std::string& device, ComediCalls& calls) {
  SubdeviceOffer offer;
  offer.number = number;
  const int type = calls.subdevice_type(number);
  offer.type = type_name(type);
  offer.channel_count = std::max(calls.channel_count(number), 0);
  if (type != kAnalogInput || offer.channel_count == 0) return offer;
  const unsigned flags = calls.subdevice_flags(number);
  offer.maxdata = calls.maxdata(number, 0);
  for (int i = 0; i < calls.range_count(number, 0); ++i) {
    if (const auto range = calls.range(number, 0, static_cast<unsigned>(i))) offer.ranges.push_back(*range);
  }
  static constexpr std::pair<unsigned, const char*> kReferences[] = {
      {subdevice_flag::kGround, "ground"},
      {subdevice_flag::kCommon, "common"},
      {subdevice_flag::kDifferential, "differential"},
      {subdevice_flag::kOther, "other"}};
  for (const auto& [flag, name] : kReferences) {
    if ((flags & flag) != 0) offer.references.emplace_back(name);
  }
  offer.can_command = (flags & subdevice_flag::kCanCommand) != 0;
  offer.soft_calibrated = (flags & subdevice_flag::kSoftCalibrated) != 0;
  if (offer.can_command) {
    constexpr double kSlowestThatCanBeAsked_Hz = 0.23284;  // 2³² − 1 ns, rounded up
    constexpr double kFastestThatCanBeAsked_Hz = 1e9;
    offer.slowest_Hz = rate_at(kSlowestThatCanBeAsked_Hz, device, number, calls);
    offer.fastest_Hz = rate_at(kFastestThatCanBeAsked_Hz, device, number, calls);
  }
  return offer;
}

/// The key that finds the board again, under whatever device file.
std::string choice(const daq::BoardInfo& board) {
  if (!board.serial.empty())
    return fmt::format("serial = \"{}\"  # finds the board under any device file\n", board.serial);
  if (!board.bus_path.empty())
    return fmt::format("bus_path = \"{}\"  # finds the board there, under any device file\n", board.bus_path);
  return {};
}

std::string configuration(const ComediBoardSettings& settings, const ComediSetup& setup,
                          const SubdeviceOffer& input) {
  return fmt::format(
      "[board]\n"
      "driver = \"comedi\"\n"
      "scan_rate = \"{:g} Hz\"            # granted: {:.9g} Hz\n"
      "[board.comedi]\n"
      "device = \"{}\"\n"
      "{}"
      "subdevice = {}\n"
      "channel = 0                     # 0 to {}: where the load cell is\n"
      "range_min = \"{:g} V\"            # what the amplifier can give\n"
      "range_max = \"{:g} V\"\n"
      "reference = \"{}\"\n"
      "[tester]\n"
      "sled_mass = \"2331 g\"            # weigh it\n"
      "load_cell_gain = \"2 N/V\"        # from its certificate or weights\n",
      settings.scan_rate_Hz, setup.info.scan_rate_granted_Hz, settings.device, choice(setup.info),
      setup.info.subdevice, input.channel_count - 1, setup.info.range_min_V, setup.info.range_max_V,
      input.references.front());
}

/// Settings that the input surely has: its widest range in volts, its first reference, a rate within its own.
std::optional<ComediBoardSettings> suited(const std::string& device, const SubdeviceOffer& input) {
  if (input.references.empty()) return std::nullopt;
  const InputRange* widest = nullptr;
  for (const InputRange& range : input.ranges) {
    if (range.in_volts && (widest == nullptr || range.max - range.min > widest->max - widest->min))
      widest = &range;
  }
  if (widest == nullptr) return std::nullopt;
  ComediBoardSettings settings;
  settings.device = device;
  settings.subdevice = input.number;
  settings.range_min_V = widest->min;
  settings.range_max_V = widest->max;
  if (input.slowest_Hz) settings.scan_rate_Hz = std::max(settings.scan_rate_Hz, *input.slowest_Hz);
  if (input.fastest_Hz) settings.scan_rate_Hz = std::min(settings.scan_rate_Hz, *input.fastest_Hz);
  const std::string& reference = input.references.front();
  settings.reference = reference == "ground"         ? AnalogReference::kGround
                       : reference == "common"       ? AnalogReference::kCommon
                       : reference == "differential" ? AnalogReference::kDifferential
                                                     : AnalogReference::kOther;
  return settings;
}

}  // namespace

BoardOffer survey_board(const std::string& device, ComediCalls& calls) {
  BoardOffer offer;
  offer.device = device;
  if (const int opened = calls.open(device); opened < 0) {
    offer.problem = explain_comedi_error(device, -opened);
    return offer;
  }
  offer.place = calls.place(device);
  offer.driver = calls.driver_name();
  offer.board = calls.board_name();
  for (int i = 0; i < calls.subdevice_count(); ++i) {
    offer.subdevices.push_back(survey_subdevice(static_cast<unsigned>(i), device, calls));
  }
  const auto input = std::find_if(offer.subdevices.begin(), offer.subdevices.end(),
                                  [](const SubdeviceOffer& subdevice) { return !subdevice.ranges.empty(); });
  if (input == offer.subdevices.end()) {
    offer.problem = fmt::format("{}: the board has no analog input", device);
    return offer;
  }
  const auto settings = suited(device, *input);
  if (!settings) {
    offer.problem =
        fmt::format("{}: subdevice {} has no range in volts or no reference", device, input->number);
    return offer;
  }
  const auto setup = agree_with_board(*settings, calls);
  if (setup) {
    offer.configuration = configuration(*settings, *setup, *input);
  } else {
    offer.problem = setup.error().message;
  }
  return offer;
}

}  // namespace stickslip::drivers
