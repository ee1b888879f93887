#include "core/pipeline/plausibility.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace stickslip::pipeline {

std::string sled_finding(double sled_mass_kg) {
  if (sled_mass_kg >= kLightestSled_kg && sled_mass_kg <= kHeaviestSled_kg) return {};
  return fmt::format("the sled mass is {:.4g} kg, outside {} … {} kg: check its unit", sled_mass_kg,
                     kLightestSled_kg, kHeaviestSled_kg);
}

void add_plausibility(analysis::TestResults& results, double sled_mass_kg,
                      const std::optional<daq::GainChange>& gain_change) {
  for (const auto& [name, estimate] :
       {std::pair{std::string_view{"static"}, &results.static_coefficient},
        std::pair{std::string_view{"kinetic"}, &results.kinetic_coefficient}}) {
    if (!estimate->value ||
        (*estimate->value >= kLowestCoefficient && *estimate->value <= kHighestCoefficient))
      continue;
    results.findings.push_back(
        fmt::format("the {} coefficient is {:.3g}, outside {} … {}: check unit and sign of the force, load "
                    "cell gain and sled mass",
                    name, *estimate->value, kLowestCoefficient, kHighestCoefficient));
  }
  if (std::string finding = sled_finding(sled_mass_kg); !finding.empty())
    results.findings.push_back(std::move(finding));
  if (gain_change) results.findings.push_back(daq::to_text(*gain_change));
}

}  // namespace stickslip::pipeline
