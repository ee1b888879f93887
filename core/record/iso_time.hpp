/// \file
/// Nanoseconds since 1970 as ISO 8601 with offset, e.g. 2026-11-21T12:53:02.123456789+00:00.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stickslip::record {

/// UTC, nine decimals, so that the way back is exact.
[[nodiscard]] std::string iso_time(std::int64_t realtime_ns);

/// Only what iso_time() writes; nothing for any other text.
[[nodiscard]] std::optional<std::int64_t> ns_from_iso_time(std::string_view text);

}  // namespace stickslip::record
