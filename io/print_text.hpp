/// \file
/// Prints text to a terminal without letting it control the terminal.
#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <string>
#include <string_view>
#include <system_error>

#include "core/base/text.hpp"

namespace stickslip::io {

namespace detail {
/// errno of a write to stdout that failed before the last flush: the stream forgets it.
inline int output_error = 0;
}  // namespace detail

/// Writes a text as it is. What cannot be written is told by flushed().
inline void print_bytes(std::FILE* stream, std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stream) != text.size() && stream == stdout)
    detail::output_error = errno;
}

/// Prints a text of several lines; characters that could control the terminal are shown by their number. Line
/// feeds pass: the caller escapes those inside names with base::printable(). \param has_colours  true: colour
/// sequences of Paint pass too. What cannot be written is told by flushed().
inline void print_text(std::FILE* stream, std::string_view text, bool has_colours = false) {
  print_bytes(stream, base::printable_lines(text, has_colours));
}

/// Prints one line to stderr: "PROGRAM: WHY".
inline void print_error(std::string_view program, std::string_view why) {
  fmt::print(stderr, "{}: {}\n", program, base::printable(why));
}

/// Exit status of a program whose output cannot be written, as on a full disk: EX_IOERR of sysexits.h. No
/// other status says that.
inline constexpr int kUnwritableStatus = 74;

/// Writes what stdout still holds. \return `status`; kUnwritableStatus, with a line on stderr, if any of the
/// output could not be written.
[[nodiscard]] inline int flushed(std::string_view program, int status) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
  const int error = errno != 0 ? errno : detail::output_error;
  print_error(program, fmt::format("the output cannot be written: {}: make room there, or write it elsewhere",
                                   std::generic_category().message(error)));
  return kUnwritableStatus;
}

}  // namespace stickslip::io
