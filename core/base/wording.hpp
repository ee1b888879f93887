/// \file
/// Helper functions for messages of one line.
#pragma once

#include <cstddef>
#include <exception>
#include <set>
#include <string>
#include <string_view>

namespace stickslip::base {

/// The first `longest` bytes of the text, or fewer so that no UTF-8 sequence is cut, as printable() shows
/// them, which may be longer; with "…" behind if the text is longer.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t longest = 60);

/// Message of an exception as one printable line; it may quote the content of a file.
[[nodiscard]] std::string reason_of(const std::exception& error);

/// The system's message for an errno value.
[[nodiscard]] std::string system_message(int error);

/// "did you mean sled_mass? Known here: …" with the known word nearest to `word` if one is within three edits
/// (bytes inserted, removed or replaced), else "known here: …". Both list all known words.
[[nodiscard]] std::string spelling_hint(std::string_view word,
                                        const std::set<std::string, std::less<>>& known);

}  // namespace stickslip::base
