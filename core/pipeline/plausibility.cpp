#include "core/pipeline/plausibility.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace stickslip::pipeline {

std::optional<base::Finding> sled_finding(double sled_mass_kg) {
  if (sled_mass_kg >= kLightestPlausibleSled_kg && sled_mass_kg <= kHeaviestPlausibleSled_kg)
    return std::nullopt;
  return base::make_finding(base::FindingCode::kSledMass,
                            fmt::format("the sled mass is {:.4g} kg, outside {} … {} kg: check its unit",
                                        sled_mass_kg, kLightestPlausibleSled_kg, kHeaviestPlausibleSled_kg),
                            {{"sled_mass", sled_mass_kg, "kg"},
                             {"lowest", kLightestPlausibleSled_kg, "kg"},
                             {"highest", kHeaviestPlausibleSled_kg, "kg"}});
}

void add_plausibility(analysis::TestResults& results, double sled_mass_kg) {
  for (const auto& [name, estimate] :
       {std::pair{std::string_view{"static"}, &results.static_coefficient},
        std::pair{std::string_view{"kinetic"}, &results.kinetic_coefficient}}) {
    if (!estimate->value ||
        (*estimate->value >= kLowestCoefficient && *estimate->value <= kHighestCoefficient))
      continue;
    base::add(
        results.findings,
        base::make_finding(
            base::FindingCode::kCoefficient,
            fmt::format("the {} coefficient is {:.3g}, outside {} … {}: check unit and sign of the force, "
                        "load cell gain and sled mass",
                        name, *estimate->value, kLowestCoefficient, kHighestCoefficient),
            {{"coefficient", *estimate->value, "1"},
             {"lowest", kLowestCoefficient, "1"},
             {"highest", kHighestCoefficient, "1"}}));
  }
  if (auto finding = sled_finding(sled_mass_kg)) base::add(results.findings, *std::move(finding));
}

}  // namespace stickslip::pipeline
