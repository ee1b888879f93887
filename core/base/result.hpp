/// \file
/// Values or reasons. Three kinds of error are kept apart in this project: a broken
/// contract stops the program (contract.hpp); a refused request and an adverse event
/// are values of these types.
///
///     Result<double> rate = parse_rate(text);
///     if (!rate) return tl::unexpected(rate.error());
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace stickslip::base {

/// Who has to act, and thereby the exit status of a program that stops because of it.
enum class ErrorKind {
  kUsage,         ///< The request or its input is wrong (exit status 2).
  kFailure,       ///< The request was right, the world was not: disk, board (exit status 1).
  kBusy,          ///< Somebody else holds what is wanted (exit status 1).
  kNoPermission,  ///< Somebody has to be given a right first (exit status 1).
  /// Somebody asked to stop; the same request goes on from there (exit status 130, as after Ctrl-C).
  kInterrupted,
};

/// One line for a person: what is wrong, where, the value, what is allowed, what to do.
struct Error {
  ErrorKind kind = ErrorKind::kFailure;
  std::string message;

  /// Exit status for a command that ends with this error: 2 usage and input, 1 failure, 130 interrupted.
  [[nodiscard]] int exit_status() const noexcept {
    switch (kind) {
      case ErrorKind::kUsage:
        return 2;
      case ErrorKind::kFailure:
      case ErrorKind::kBusy:
      case ErrorKind::kNoPermission:
        return 1;
      case ErrorKind::kInterrupted:
        return 130;
    }
    return 1;
  }
};

template <typename T>
using Result = tl::expected<T, Error>;

/// Wrong request or input. \param format,args as for fmt::format.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> usage_error(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kUsage, fmt::format(format, std::forward<Args>(args)...)});
}

/// The world did not allow it. \param format,args as for fmt::format.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> failure(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kFailure, fmt::format(format, std::forward<Args>(args)...)});
}

}  // namespace stickslip::base
