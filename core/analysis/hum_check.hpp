/// \file
/// Hum of the mains in a test, and what it does to the regime.
#pragma once

#include <optional>

#include "core/analysis/results.hpp"
#include "core/base/finding.hpp"
#include "core/base/long_column.hpp"
#include "core/detect/fall_finder.hpp"
#include "core/estimate/trace.hpp"

namespace stickslip::analysis {

/// Largest amplitude of hum, as a coefficient, that is no finding: a twentieth of a typical S − K. What is
/// left of it after 17 scans a cycle is a ripple on the peaks.
inline constexpr double kLargestHum = 0.0025;

/// Frequencies of the mains.
inline constexpr double kMains_Hz[] = {50.0, 60.0};

/// Lowest scan rate at which hum is looked for: below twice 60 Hz the scans cannot show it, and close to that
/// not its phase.
inline constexpr double kLowestRateForHum_Hz = 2.2 * 60.0;

struct Hum {
  double frequency_Hz = 0.0;
  double amplitude = 0.0;
  bool is_of_falls = false;  ///< The falls found are the hum itself.
};

/// Hum of 50 or 60 Hz whose median amplitude, over stretches under load, exceeds kLargestHum by three
/// standard errors. Without slips at least 8 stretches of 0.2 s are needed. With slips at least 2 of 1 s, and
/// the amplitude must be a quarter of the median drop. In a test whose slips are larger, only the self-check
/// before it sees hum (pipeline/self_check.hpp). nullopt if there is none, and below kLowestRateForHum_Hz.
[[nodiscard]] std::optional<Hum> find_hum(const estimate::Trace& trace,
                                          const base::LongColumn<detect::Fall>& slips, double scan_rate_Hz);

[[nodiscard]] base::Finding hum_finding(const Hum& hum, model::Regime regime);

}  // namespace stickslip::analysis
