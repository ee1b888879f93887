#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/print_text.hpp"
#include <nlohmann/json.hpp>

#include "drivers/comedi/board_survey.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;
using drivers::BoardOffer;
using drivers::SubdeviceOffer;

struct BoardsOptions {
  std::vector<std::string> devices;  ///< Empty: all there are.
  bool json = false;
};

Json to_json(const SubdeviceOffer& offer) {
  Json json{{"subdevice", offer.number}, {"type", offer.type}, {"channel_count", offer.channel_count}};
  if (offer.ranges.empty()) return json;
  json["maxdata"] = offer.maxdata;
  Json ranges = Json::array();
  for (const drivers::InputRange& range : offer.ranges) {
    ranges.push_back(
        {{"min", range.min}, {"max", range.max}, {"unit", range.in_volts ? Json("V") : Json(nullptr)}});
  }
  json["ranges"] = ranges;
  json["references"] = offer.references;
  json["can_command"] = offer.can_command;
  json["soft_calibrated"] = offer.soft_calibrated;
  json["scan_rate_min"] = offer.slowest_Hz ? Json(*offer.slowest_Hz) : Json(nullptr);
  json["scan_rate_max"] = offer.fastest_Hz ? Json(*offer.fastest_Hz) : Json(nullptr);
  return json;
}

Json to_json(const BoardOffer& offer) {
  Json json{{"device", offer.device}, {"usable", offer.usable()}};
  json["problem"] = offer.usable() ? Json(nullptr) : Json(offer.problem);
  json["driver"] = offer.driver;
  json["board"] = offer.board;
  json["serial"] = offer.place.serial.empty() ? Json(nullptr) : Json(offer.place.serial);
  json["bus_path"] = offer.place.bus_path.empty() ? Json(nullptr) : Json(offer.place.bus_path);
  json["subdevices"] = Json::array();
  for (const SubdeviceOffer& subdevice : offer.subdevices) json["subdevices"].push_back(to_json(subdevice));
  json["configuration"] = offer.configuration.empty() ? Json(nullptr) : Json(offer.configuration);
  return json;
}

std::string line_of(const SubdeviceOffer& offer) {
  std::string line =
      fmt::format("  subdevice {}: {}, {} channels", offer.number, offer.type, offer.channel_count);
  if (offer.ranges.empty()) return line + "\n";
  line += fmt::format(", codes 0 to {}\n    ranges:", offer.maxdata);
  for (const drivers::InputRange& range : offer.ranges) {
    line += fmt::format(" {:g} to {:g} {};", range.min, range.max, range.in_volts ? "V" : "(no volts)");
  }
  line.back() = '\n';
  line += fmt::format("    references: {}\n", fmt::join(offer.references, ", "));
  if (offer.slowest_Hz && offer.fastest_Hz) {
    line += fmt::format("    scan rates: {:.6g} to {:.6g} Hz, timed by the board\n", *offer.slowest_Hz,
                        *offer.fastest_Hz);
  } else {
    line += "    scan rates: up to 2000 Hz, timed by this computer (acquisition = \"polled\")\n";
  }
  line += fmt::format("    calibration: {}\n", offer.soft_calibrated ? "soft" : "hard");
  return line;
}

std::string text_of(const BoardOffer& offer) {
  if (offer.board.empty() && !offer.usable()) return offer.problem + "\n";
  std::string text = fmt::format("{}: {} (driver {})\n", offer.device, offer.board, offer.driver);
  if (!offer.place.serial.empty()) text += fmt::format("  serial: {}\n", offer.place.serial);
  if (!offer.place.bus_path.empty()) text += fmt::format("  bus_path: {}\n", offer.place.bus_path);
  for (const SubdeviceOffer& subdevice : offer.subdevices) text += line_of(subdevice);
  text += offer.usable() ? fmt::format("  a configuration for it:\n\n{}\n", offer.configuration)
                         : fmt::format("  cannot be used: {}\n", offer.problem);
  return text;
}

/// \return 0 if any board can be used.
int run_boards(const BoardsOptions& options) {
  const std::vector<std::string> devices =
      options.devices.empty() ? drivers::comedi_devices() : options.devices;
  bool any_usable = false;
  std::string text;
  Json list = Json::array();
  for (const std::string& device : devices) {
    const auto calls = drivers::make_comedi_calls();
    const BoardOffer offer = drivers::survey_board(device, *calls);
    any_usable = any_usable || offer.usable();
    if (options.json) {
      list.push_back(to_json(offer));
    } else {
      text += text_of(offer);
    }
  }
  if (options.json) {
    text = io::json_document(Json{{"boards", list}});
  } else if (devices.empty()) {
    text =
        "no board: there is no /dev/comedi*; plug one in, load its driver, or try the kernel's virtual one: "
        "sudo modprobe comedi_test\n";
  }
  io::print_text(stdout, text);
  return io::flushed("stickslip", any_usable ? 0 : 1);
}

constexpr const char* kBoardsExamples =
    R"(Examples:
  stickslip boards
  stickslip boards /dev/comedi0
  stickslip boards --json)";

}  // namespace

void add_boards(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<BoardsOptions>();
  CLI::App* command = app.add_subcommand(
      "boards",
      "list the boards under Linux Comedi and what a configuration should say; 1 if none can be used");
  command->footer(kBoardsExamples);
  command->add_option("devices", options->devices, "only these; else all of /dev/comedi*")
      ->type_name("DEVICE");
  command->add_flag("--json", options->json, "JSON instead of text");
  command->callback([&chosen, options] { chosen.run = [options] { return run_boards(*options); }; });
}

}  // namespace stickslip::cli
