/// \file
/// Result of a function that may fail: a value or an Error. A broken contract stops the program instead
/// (contract.hpp).
///
///     Result<double> rate = parse_rate(text);
///     if (!rate) return tl::unexpected(rate.error());
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include <tl/expected.hpp>

namespace stickslip::base {

/// Kind of an error; it determines the exit status of a program that stops because of it.
enum class ErrorKind {
  kUsage,         ///< The request or its input is wrong (exit status 2).
  kFailure,       ///< A valid request failed, for example at the disk or the board (exit status 1).
  kBusy,          ///< The resource is in use by another process (exit status 1).
  kNoPermission,  ///< A permission is missing (exit status 1).
  /// The user stopped the request before its end (exit status 130, as after Ctrl-C).
  kInterrupted,
};

/// An error with one line for the user: what is wrong, where, the value, what is allowed, what to do.
struct Error {
  ErrorKind kind = ErrorKind::kFailure;
  std::string message;
  /// A child process gave no answer: it died by a limit, an exception or a signal, or its answer was too
  /// long.
  bool worker_died = false;

  /// Exit status for a command that ends with this error: 2 usage and input, 130 interrupted, else 1.
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

/// Error of kind kUsage: the request or its input is wrong. \param format,args as for fmt::format.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> usage_error(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kUsage, fmt::format(format, std::forward<Args>(args)...)});
}

/// Error of kind kFailure: a valid request failed. \param format,args as for fmt::format.
template <typename... Args>
[[nodiscard]] tl::unexpected<Error> failure(fmt::format_string<Args...> format, Args&&... args) {
  return tl::unexpected(Error{ErrorKind::kFailure, fmt::format(format, std::forward<Args>(args)...)});
}

}  // namespace stickslip::base
