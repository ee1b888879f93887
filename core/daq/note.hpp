/// \file
/// Note: a command of the user, or a disturbance of the computer, at a scan of a test. The record stores it
/// as an event; a replay repeats it at the same scan.
///
///     "command: start, by ada"   "command: stop, by ada"   "mark: the sheet moved"   "bench: zero set to
///     0.01 V"   "stall: this scan was read 41.3 s late"   "clock step: the date went 3600 s back"
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/scan_index.hpp"

namespace stickslip::daq {

struct Note {
  enum class Kind {
    kStart,  ///< A command began the test at this scan.
    kStop,   ///< A command ended the test; this is its last scan.
    kMark,   ///< A remark.
    kBench,  ///< The bench was armed, tared or calibrated before the test; placed at its first scan.
    kStall,  ///< The computer stalled; this scan was read late.
    kStep,   ///< The computer's date was set.
  };
  Kind kind = Kind::kMark;
  base::ScanIndex scan = 0;
  std::string text;  ///< Of kStart and kStop: name of the user; otherwise a description.

  bool operator==(const Note&) const = default;
};

namespace note_words {
inline constexpr std::string_view kStart = "command: start, by ";
inline constexpr std::string_view kStop = "command: stop, by ";
inline constexpr std::string_view kMark = "mark: ";
inline constexpr std::string_view kBench = "bench: ";
inline constexpr std::string_view kStall = "stall: ";
inline constexpr std::string_view kStep = "clock step: ";
}  // namespace note_words

/// Text of the event by which a record stores the note.
[[nodiscard]] inline std::string to_text(const Note& note) {
  switch (note.kind) {
    case Note::Kind::kStart:
      return fmt::format("{}{}", note_words::kStart, note.text);
    case Note::Kind::kStop:
      return fmt::format("{}{}", note_words::kStop, note.text);
    case Note::Kind::kBench:
      return fmt::format("{}{}", note_words::kBench, note.text);
    case Note::Kind::kStall:
      return fmt::format("{}{}", note_words::kStall, note.text);
    case Note::Kind::kStep:
      return fmt::format("{}{}", note_words::kStep, note.text);
    case Note::Kind::kMark:
      break;
  }
  return fmt::format("{}{}", note_words::kMark, note.text);
}

/// Inverse of to_text(): the note of an event of a record, at this scan; nullopt for any other event.
[[nodiscard]] inline std::optional<Note> parse_note(base::ScanIndex scan, std::string_view event) {
  const auto as = [&](Note::Kind kind, std::string_view words) {
    return Note{kind, scan, std::string{event.substr(words.size())}};
  };
  if (event.starts_with(note_words::kStart)) return as(Note::Kind::kStart, note_words::kStart);
  if (event.starts_with(note_words::kStop)) return as(Note::Kind::kStop, note_words::kStop);
  if (event.starts_with(note_words::kMark)) return as(Note::Kind::kMark, note_words::kMark);
  if (event.starts_with(note_words::kBench)) return as(Note::Kind::kBench, note_words::kBench);
  if (event.starts_with(note_words::kStall)) return as(Note::Kind::kStall, note_words::kStall);
  if (event.starts_with(note_words::kStep)) return as(Note::Kind::kStep, note_words::kStep);
  return std::nullopt;
}

}  // namespace stickslip::daq
