#include "core/daq/gain_change.hpp"

#include <fmt/format.h>

#include <cmath>

namespace stickslip::daq {

std::optional<GainChange> gain_change(double gain_N_per_V, std::optional<double> in_use_N_per_V) noexcept {
  if (!in_use_N_per_V || *in_use_N_per_V == 0.0) return std::nullopt;
  const GainChange change{gain_N_per_V, *in_use_N_per_V};
  if (std::abs(change.ratio() - 1.0) <= kLargestGainChange) return std::nullopt;
  return change;
}

std::string to_text(const GainChange& change) {
  return fmt::format(
      "the load cell gain {:.6g} N/V is {:.4g} times the {:.6g} N/V in use before, a change of more than "
      "{:g} "
      "%: check the unit of each mass, the amplifier's range and the load cell",
      change.gain_N_per_V, change.ratio(), change.in_use_N_per_V, 100.0 * kLargestGainChange);
}

base::Finding finding(const GainChange& change) {
  return base::make_finding(base::FindingCode::kGainChange, to_text(change),
                            {{"gain", change.gain_N_per_V, "N/V"},
                             {"gain_before", change.in_use_N_per_V, "N/V"},
                             {"ratio", change.ratio(), "1"},
                             {"limit", kLargestGainChange, "1"}});
}

}  // namespace stickslip::daq
