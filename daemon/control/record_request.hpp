/// \file
/// A record as it lies on the disk, for whoever asks for it by its name.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "daemon/types/http.hpp"
#include "daemon/types/test_log.hpp"

namespace stickslip::control {

/// Larger ones are copied from the disk: the answer is held in memory.
inline constexpr std::uintmax_t kLargestServed = std::uintmax_t{64} << 20U;

/// \param name  compared with the file names of these tests and used for nothing else: no text from outside
/// reaches the file system. \return 404 where no test has it, or it is too large or gone.
[[nodiscard]] daemon::HttpReply record_reply(const std::string& name,
                                             std::span<const daemon::TestSummary> tests);

}  // namespace stickslip::control
