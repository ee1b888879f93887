#include "drivers/comedi/board_search.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <optional>

#include "drivers/comedi/comedi_errors.hpp"

namespace stickslip::drivers {
namespace {

/// A device file and the board behind it.
struct Candidate {
  std::string device;
  int error = 0;  ///< errno of opening it; then the name is not known.
  BoardIdentity identity;
};

Candidate look_at(const std::string& device, ComediCalls& calls) {
  Candidate candidate{device, 0, {}};
  if (const int result = calls.open(device); result < 0) {
    candidate.error = -result;
  } else {
    candidate.identity = {calls.board_name(), calls.driver_name(), {}};
  }
  candidate.identity.place = calls.place(device);
  return candidate;
}

bool applies(const std::string& wanted, const std::string& found) {
  return wanted.empty() || wanted == found;
}

/// Whether serial and bus path, which need no permission, are those chosen.
bool is_in_place(const BoardChoice& choice, const BoardPlace& place) {
  return applies(choice.serial, place.serial) && applies(choice.bus_path, place.bus_path);
}

std::string text_of(const BoardChoice& choice) {
  std::vector<std::string> parts;
  if (!choice.board.empty()) parts.push_back(fmt::format("board \"{}\"", choice.board));
  if (!choice.serial.empty()) parts.push_back(fmt::format("serial \"{}\"", choice.serial));
  if (!choice.bus_path.empty()) parts.push_back(fmt::format("bus_path \"{}\"", choice.bus_path));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string text_of(const BoardIdentity& identity) {
  std::string text = full_name(identity);
  if (!identity.place.serial.empty()) text += fmt::format(", serial \"{}\"", identity.place.serial);
  if (!identity.place.bus_path.empty()) text += fmt::format(", bus_path \"{}\"", identity.place.bus_path);
  return text;
}

std::string text_of(const Candidate& candidate) {
  if (candidate.error == 0) return fmt::format("{}: {}", candidate.device, text_of(candidate.identity));
  return explain_comedi_error(candidate.device, candidate.error);
}

/// "; there is /dev/comedi1: …"; empty if there is no other board.
std::string others(const std::vector<Candidate>& candidates) {
  std::vector<std::string> texts;
  for (const Candidate& candidate : candidates) {
    // A reserved device file without a board behind it is no board.
    if (candidate.error != ENODEV && candidate.error != ENXIO) texts.push_back(text_of(candidate));
  }
  return texts.empty() ? "" : fmt::format("; there is {}", fmt::join(texts, " and "));
}

std::vector<Candidate> look_around(ComediCalls& calls, const std::string& except = {}) {
  std::vector<Candidate> candidates;
  for (const std::string& device : calls.devices()) {
    if (device != except) candidates.push_back(look_at(device, calls));
  }
  calls.close();
  return candidates;
}

base::Result<std::string> opened(const std::string& device, ComediCalls& calls) {
  if (const int result = calls.open(device); result < 0) return tl::unexpected(comedi_error(device, -result));
  return device;
}

base::Result<std::string> open_by_choice(const BoardChoice& choice, ComediCalls& calls) {
  const std::vector<Candidate> candidates = look_around(calls);
  std::vector<const Candidate*> found;
  const Candidate* refused = nullptr;
  for (const Candidate& candidate : candidates) {
    if (!is_in_place(choice, candidate.identity.place)) continue;
    if (candidate.error == 0 && applies(choice.board, candidate.identity.board)) {
      found.push_back(&candidate);
    } else if (candidate.error == EACCES || candidate.error == EPERM || candidate.error == EBUSY) {
      refused = &candidate;  // It may be the one.
    }
  }
  if (found.size() == 1) return opened(found.front()->device, calls);
  if (found.size() > 1) {
    return base::failure(
        "{} fits {} and {}; add serial or bus_path to [board.comedi], as stickslip boards tells them",
        text_of(choice), text_of(*found[0]), text_of(*found[1]));
  }
  if (refused != nullptr) return tl::unexpected(comedi_error(refused->device, refused->error));
  return base::failure("no board with {}: plug it in, or correct [board.comedi]{}", text_of(choice),
                       others(candidates));
}

/// Why this is not the board that acquired before; empty if it is.
std::string difference(const daq::BoardInfo& before, const BoardIdentity& now) {
  const std::string name = full_name(now);
  if (before.board_name != name) return fmt::format("not {}", before.board_name);
  const bool both = !before.serial.empty() && !now.place.serial.empty();
  if (both && before.serial != now.place.serial) return fmt::format("not serial \"{}\"", before.serial);
  return {};
}

base::Result<std::string> open_by_path(const ComediBoardSettings& settings, ComediCalls& calls) {
  const std::string& device = settings.device;
  const Candidate candidate = look_at(device, calls);
  const bool missing = candidate.error == ENOENT || candidate.error == ENODEV || candidate.error == ENXIO;
  if (candidate.error != 0) {
    base::Error error = comedi_error(device, candidate.error);
    if (!missing) return tl::unexpected(std::move(error));
    const std::string instead = others(look_around(calls, device));
    if (!instead.empty())
      error.message +=
          instead +
          "; to have a board found under any device file, say its serial or bus_path in [board.comedi]";
    return tl::unexpected(std::move(error));
  }
  if (!settings.before) return device;
  const std::string why = difference(*settings.before, candidate.identity);
  if (why.empty()) return device;
  return base::failure(
      "{}: another board has this device file now: {}, {} as before{}; plug that in again, or reload to take "
      "this "
      "one; to have a board found under any device file, say its serial or bus_path in [board.comedi]",
      device, text_of(candidate.identity), why, others(look_around(calls, device)));
}

}  // namespace

std::string full_name(const BoardIdentity& identity) {
  return fmt::format("{} ({})", identity.board, identity.driver);
}

base::Result<std::string> open_chosen(const ComediBoardSettings& settings, ComediCalls& calls) {
  return settings.choice.empty() ? open_by_path(settings, calls) : open_by_choice(settings.choice, calls);
}

}  // namespace stickslip::drivers
