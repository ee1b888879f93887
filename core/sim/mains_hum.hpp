/// \file
/// Mains hum at a scan, as a function of the scan index.
#pragma once

#include <cstdint>

#include "core/sim/signal_settings.hpp"

namespace stickslip::sim {

/// Mains cycles since the first scan, less a whole number: from 0 to 1 or a little outside. The error is
/// within 2 ulp of one cycle, for any scan index from 0 to 2⁵³. The product of frequency and index is kept in
/// two doubles [error-free product by fused multiply-add: Ogita, Rump and Oishi, SIAM J. Sci. Comput.
/// 26(6):1955–1988, 2005, Alg. 3.5], and fmod is exact.
[[nodiscard]] double mains_cycles(double frequency_Hz, double scan_rate_Hz, std::int64_t scan) noexcept;

/// Hum at this scan. \param scan_rate_Hz  true. \param scan  0 ≤ scan < 2⁵³
[[nodiscard]] double mains_hum_V(const MainsHum& hum, double scan_rate_Hz, std::int64_t scan) noexcept;

}  // namespace stickslip::sim
