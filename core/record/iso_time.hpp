/// \file
/// Nanoseconds since 1970 as ISO 8601 with offset, e.g. 2026-11-21T12:53:02.123456789+00:00.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stickslip::record {

/// Text of a time in ns since 1970: UTC, nine decimals.
[[nodiscard]] std::string iso_time(std::int64_t realtime_ns);

/// Inverse of iso_time(), exact; nullopt for any other text, and for times whose whole second lies beyond
/// ±9 223 372 035 (1677 and 2262), near the ends of the range.
[[nodiscard]] std::optional<std::int64_t> ns_from_iso_time(std::string_view text);

}  // namespace stickslip::record
