/// \file
/// Comparison of a new gain of the load cell with the one in use: a mistyped unit of a weight makes the gain
/// wrong by a factor of 9.8 or 1000.
#pragma once

#include <optional>
#include <string>

#include "core/base/finding.hpp"

namespace stickslip::daq {

/// Largest relative change that needs no confirmation. Load cells and amplifiers drift by less than 1 %;
/// another range of the amplifier or another cell changes the gain by more.
inline constexpr double kLargestGainChange = 0.2;
/// Code of the refusal that asks for a confirmation; also the name of FindingCode::kGainChange.
inline constexpr const char* kGainChangeCode = "gain-change";

/// A change of the gain by more than kLargestGainChange.
struct GainChange {
  double gain_N_per_V = 0.0;
  double in_use_N_per_V = 0.0;

  [[nodiscard]] double ratio() const noexcept { return gain_N_per_V / in_use_N_per_V; }
};

/// The change from the gain in use to the new one; nullopt if it is at most kLargestGainChange or no gain is
/// in use. A changed sign is a change.
/// \param in_use_N_per_V  nullopt or 0: none is in use.
[[nodiscard]] std::optional<GainChange> gain_change(double gain_N_per_V,
                                                    std::optional<double> in_use_N_per_V) noexcept;

/// One sentence with both gains, their ratio, the limit, and what to check.
[[nodiscard]] std::string to_text(const GainChange& change);
[[nodiscard]] base::Finding finding(const GainChange& change);

}  // namespace stickslip::daq
