/// \file
/// Checks the scan rate against the expected frequency of the oscillation.
#pragma once

#include <optional>
#include <string>

#include "core/estimate/shared_prior.hpp"
#include "core/model/tester.hpp"

namespace stickslip::estimate {

/// Fewest scans a cycle that are accepted. Below, the detector's median of three flattens the peaks.
inline constexpr double kFewestScansACycle = 3.0;
/// Fewest scans a cycle without a warning. Below, the largest scan may be under the peak by more than 1 −
/// cos(π/8) = 7.6 % of the amplitude.
inline constexpr double kFewScansACycle = 8.0;

struct SamplingVerdict {
  enum class Kind { kFine, kFew, kRefused, kNotVerifiable };
  Kind kind = Kind::kNotVerifiable;
  std::string reason;  ///< For people; empty if fine.
};

/// Expected frequency: ω/2π if the prior has a characterisation (SharedPrior::coupling), else √(k/m)/2π;
/// nullopt without either that or stiffness and sled mass.
[[nodiscard]] std::optional<double> expected_frequency_Hz(const model::Tester& tester,
                                                          const SharedPrior& prior);

/// Judges the scans a cycle: refused below kFewestScansACycle, few below kFewScansACycle, not verifiable
/// without a frequency.
/// \param scan_rate_Hz > 0.
[[nodiscard]] SamplingVerdict check_sampling(double scan_rate_Hz, std::optional<double> frequency_Hz);

}  // namespace stickslip::estimate
