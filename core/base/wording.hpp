/// \file
/// Helper functions for messages of one line.
#pragma once

#include <cstddef>
#include <exception>
#include <set>
#include <string>
#include <string_view>

namespace stickslip::base {

/// The text as printable() shows it, cut after about `longest` bytes, never inside a UTF-8 sequence.
[[nodiscard]] std::string one_line(std::string_view text, std::size_t longest = 60);

/// Message of an exception as one printable line; it may quote the content of a file.
[[nodiscard]] std::string reason_of(const std::exception& error);

/// The system's message for an errno value.
[[nodiscard]] std::string system_message(int error);

/// "did you mean sled_mass? Known here: …" if a known word is within three edits of `word`,
/// else "known here: …".
[[nodiscard]] std::string spelling_hint(std::string_view word,
                                        const std::set<std::string, std::less<>>& known);

}  // namespace stickslip::base
