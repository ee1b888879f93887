/// \file
/// Days and times as they are typed.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::catalogue {

/// Half-open, ns since 1970.
struct Moment {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
};

/// "2026-11-21", "2026-11-21T12:53", "2026-11-21T12:53:02": that day, minute or second, by the local clock;
/// with Z, +01:00 or -0500 behind a time, by that one. A blank does for the T. Years 1700 to 2200. \param
/// place  of the text, for the error: kUsage.
[[nodiscard]] base::Result<Moment> moment_from_text(const std::string& text, const std::string& place);

/// "2026-11-21 12:53", by the local clock.
[[nodiscard]] std::string local_minute(std::int64_t realtime_ns);

}  // namespace stickslip::catalogue
