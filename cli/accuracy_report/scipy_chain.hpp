/// \file
/// Runs scenes through a chain of SciPy functions, for comparison: median of five, Savitzky–Golay filter,
/// find_peaks. The script cli/accuracy_report/scipy_chain.py is built into the program; it runs in a child
/// process, which measures its own time over whole arrays.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/accuracy/tiers.hpp"
#include "core/base/result.hpp"

namespace stickslip::accuracy_report {

/// Name of the chain in tables.
inline constexpr std::string_view kScipyChain = "SciPy, whole array";

/// Runs the scenes; blocks. Errors: kFailure without /usr/bin/python3 and Debian's python3-scipy.
[[nodiscard]] base::Result<std::vector<accuracy::PeerOutcome>> run_scipy_chain(
    std::span<const accuracy::TierScene> scenes);

}  // namespace stickslip::accuracy_report
