/// \file
/// A new gain of the load cell against the one in use: a mistyped unit of a weight is off by 9.8 or by 1000.
#pragma once

#include <optional>
#include <string>

#include "core/base/finding.hpp"

namespace stickslip::daq {

/// Largest relative change that needs no confirmation. Load cells and amplifiers drift by less than 1 %;
/// another range of the amplifier or another cell changes the gain by more.
inline constexpr double kLargestGainChange = 0.2;
inline constexpr const char* kGainChangeCode = "gain-change";

/// A change by more than kLargestGainChange.
struct GainChange {
  double gain_N_per_V = 0.0;
  double in_use_N_per_V = 0.0;

  [[nodiscard]] double ratio() const noexcept { return gain_N_per_V / in_use_N_per_V; }
};

/// \param in_use_N_per_V  nothing or 0: no gain is known. \return nothing if the gain changes by at most
/// kLargestGainChange. A changed sign is a change.
[[nodiscard]] std::optional<GainChange> gain_change(double gain_N_per_V,
                                                    std::optional<double> in_use_N_per_V) noexcept;

/// The change with both gains, their ratio, the limit, and what to check.
[[nodiscard]] std::string to_text(const GainChange& change);
[[nodiscard]] base::Finding finding(const GainChange& change);

}  // namespace stickslip::daq
