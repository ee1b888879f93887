/// \file
/// Serves the file of a record by its name.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "daemon/types/http.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::control {

/// Largest record that is served, bytes: the reply is held in memory. Larger ones must be copied from the
/// disk.
inline constexpr std::uintmax_t kLargestServed = std::uintmax_t{64} << 20U;

/// Reads the file of the test whose record has this name. \param name  is only compared with the file names
/// of `tests`, so that no path from outside reaches the file system. \return 404 if no test has this name, or
/// its file is too large or missing.
[[nodiscard]] daemon::HttpReply record_reply(const std::string& name,
                                             std::span<const daemon::TestSummary> tests);

}  // namespace stickslip::control
