/// \file
/// Numbers of the command line of a program of bench/.
///
///     const auto tests = test::argument<std::uint64_t>(argc, argv, 1, 1000);
#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <type_traits>

namespace stickslip::test {

/// argv[which], or `otherwise` where it is not given. Anything but a count above 0, or a number from 0 on for
/// a floating-point type, ends the program with status 2.
template <typename T>
T argument(int argc, char** argv, int which, T otherwise) {
  if (argc <= which) return otherwise;
  T value{};
  const std::string_view text{argv[which]};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  constexpr bool kWhole = std::is_integral_v<T>;
  const bool fits = kWhole ? value > T{} : value >= T{};
  if (error == std::errc{} && end == text.data() + text.size() && fits) return value;
  fmt::print(stderr, "{}: '{}' is no {} that it can take\n", argv[0], text,
             kWhole ? "whole number above 0" : "number from 0 on");
  std::exit(2);
}

}  // namespace stickslip::test
