/// \file
/// The same scenes by SciPy: median of five, Savitzky–Golay filter, find_peaks
/// (cli/accuracy_report/scipy_chain.py, built into the program), in a process of its own, which measures its
/// own time over whole arrays.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/accuracy/tiers.hpp"
#include "core/base/result.hpp"

namespace stickslip::accuracy_report {

inline constexpr std::string_view kScipyChain = "SciPy, whole array";

/// Errors: kFailure without /usr/bin/python3 and Debian's python3-scipy.
[[nodiscard]] base::Result<std::vector<accuracy::PeerOutcome>> run_scipy_chain(
    std::span<const accuracy::TierScene> scenes);

}  // namespace stickslip::accuracy_report
