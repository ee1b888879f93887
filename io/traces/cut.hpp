/// \file
/// Cuts a trace of several tests.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/scan_index.hpp"

namespace stickslip::traces {

/// Ranges [begin, end) of scans that together are the whole trace, one for each test that the daemon's
/// segmenter finds; they meet in the middle between the end of one test and the beginning of the next. One
/// range if it finds fewer than two.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> tests_in(
    const std::vector<base::ScanIndex>& scan, const std::vector<double>& coefficient, double rate_Hz);

}  // namespace stickslip::traces
