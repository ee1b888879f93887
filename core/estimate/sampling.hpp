/// \file
/// Do the scans come often enough for the oscillation that is to be expected?
#pragma once

#include <optional>
#include <string>

#include "core/estimate/shared_prior.hpp"
#include "core/model/tester.hpp"

namespace stickslip::estimate {

/// Below this many scans a cycle peaks alias: a median of three, which the detector runs on, flattens what is
/// shorter.
inline constexpr double kFewestScansACycle = 3.0;
/// Below this many the largest scan misses the peak by more than 1 − cos(π/8) = 7.6 % of the amplitude.
inline constexpr double kFewScansACycle = 8.0;

struct SamplingVerdict {
  enum class Kind { kFine, kFew, kRefused, kNotVerifiable };
  Kind kind = Kind::kNotVerifiable;
  std::string reason;  ///< For people; empty if fine.
};

/// f of the plan: ω/2π if the tester is characterised, √(k/m)/2π from a stiffness; nothing without either.
[[nodiscard]] std::optional<double> expected_frequency_Hz(const model::Tester& tester,
                                                          const SharedPrior& prior);

/// \param scan_rate_Hz > 0.
[[nodiscard]] SamplingVerdict check_sampling(double scan_rate_Hz, std::optional<double> frequency_Hz);

}  // namespace stickslip::estimate
