/// \file
/// Cuts a trace of several tests.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/long_column.hpp"
#include "core/base/scan_index.hpp"

namespace stickslip::traces {

/// Ranges [begin, end) of scans that together are the whole trace, one for each test that the daemon's
/// segmenter finds; they meet in the middle between the end of one test and the beginning of the next. One
/// range if it finds fewer than two.
/// \param coefficient  of each of the scans.
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> tests_in(
    const base::LongColumn<base::ScanIndex>& scan, const std::function<double(std::size_t)>& coefficient,
    double rate_Hz);

}  // namespace stickslip::traces
