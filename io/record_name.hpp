/// \file
/// File names of records: the time at which the test began, and its number.
#pragma once

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>

namespace stickslip::io {

/// "20261121T125252Z-0003". \param seconds  since 1970, UTC.
[[nodiscard]] inline std::string record_stem(std::time_t seconds, std::int64_t test_number) {
  return fmt::format("{:%Y%m%dT%H%M%SZ}-{:04}", fmt::gmtime(seconds), test_number);
}

/// The test number in such a name, which may have folders before it and anything after it; nothing if there
/// is none.
[[nodiscard]] inline std::optional<std::int64_t> test_number_in(std::string_view name) {
  constexpr std::string_view kAfterTime = "Z-";
  const std::size_t at = name.rfind(kAfterTime);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view digits = name.substr(at + kAfterTime.size());
  std::int64_t number = 0;
  const auto [stopped, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc{} || number < 1) return std::nullopt;
  return number;
}

}  // namespace stickslip::io
