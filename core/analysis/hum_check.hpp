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

/// Largest amplitude of hum, as a coefficient, that is no finding: a twentieth of a typical S − K.
inline constexpr double kLargestHum = 0.0025;

/// Frequencies of the mains.
inline constexpr double kMains_Hz[] = {50.0, 60.0};

/// Lowest scan rate at which hum is looked for: below twice 60 Hz the scans cannot show it, and close to that
/// not its phase.
inline constexpr double kLowestRateForHum_Hz = 2.2 * 60.0;

/// Hum found by find_hum().
struct Hum {
  double frequency_Hz = 0.0;
  double amplitude = 0.0;    ///< As a coefficient.
  bool is_of_falls = false;  ///< The falls found are the hum itself.
};

/// Hum of 50 or 60 Hz, the larger of the two. Its median amplitude, over stretches in which the force is at
/// least a third of its largest, exceeds kLargestHum by three standard errors of a stretch. Without slips at
/// least 8 stretches of 0.2 s are needed. With slips at least 2 of 1 s are needed, and the amplitude must be
/// a quarter of the median drop; the falls are then the hum (is_of_falls). Beside larger slips this function
/// sees no hum; only the self-check before the test does (pipeline/self_check.hpp).
/// \return nullopt if there is none, below kLowestRateForHum_Hz, and for an empty trace.
[[nodiscard]] std::optional<Hum> find_hum(const estimate::Trace& trace,
                                          const base::LongColumn<detect::Fall>& slips, double scan_rate_Hz);

/// Finding kHum.
/// \param regime  of the test; the text says so if it is undecided and hum.is_of_falls is false.
[[nodiscard]] base::Finding hum_finding(const Hum& hum, model::Regime regime);

}  // namespace stickslip::analysis
