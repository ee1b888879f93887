#include "core/pipeline/plausibility.hpp"

#include <gmock/gmock.h>

namespace stickslip::pipeline {
namespace {

using analysis::Estimate;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> findings(Estimate static_coefficient, Estimate kinetic_coefficient,
                                  double sled_mass_kg) {
  analysis::TestResults results;
  results.static_coefficient = std::move(static_coefficient);
  results.kinetic_coefficient = std::move(kinetic_coefficient);
  add_plausibility(results, sled_mass_kg);
  return base::texts_of(results.findings);
}

TEST(Plausibility, LimitsThemselvesAreNoFinding) {
  EXPECT_THAT(findings(Estimate::of(kHighestCoefficient), Estimate::of(kLowestCoefficient),
                       kLightestPlausibleSled_kg),
              IsEmpty());
  EXPECT_THAT(findings(Estimate::none("no peak"), Estimate::of(0.3), kHeaviestPlausibleSled_kg), IsEmpty());
}

TEST(Plausibility, ForceInAnotherUnitIsAFindingInFewDigits) {
  EXPECT_THAT(findings(Estimate::of(380.0), Estimate::of(3.02e299), 2.331),
              ElementsAre(HasSubstr("static coefficient is 380, outside 0.01 … 5"),
                          HasSubstr("kinetic coefficient is 3.02e+299,")));
  EXPECT_THAT(findings(Estimate::of(0.38), Estimate::of(-0.3), 2.331),
              ElementsAre(HasSubstr("kinetic coefficient is -0.3,")));
}

TEST(Plausibility, SledInGramsIsAFinding) {
  EXPECT_THAT(findings(Estimate::of(0.38), Estimate::of(0.3), 2331.0),
              ElementsAre(HasSubstr("sled mass is 2331 kg, outside 0.005 … 20 kg")));
}

}  // namespace
}  // namespace stickslip::pipeline
