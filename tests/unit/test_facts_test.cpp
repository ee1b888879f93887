#include "core/pipeline/test_facts.hpp"

#include <gmock/gmock.h>

namespace stickslip::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A test on a sound bench.
struct Sound {
  daq::SelfCheck check;
  TestFacts facts{.scan_rate_Hz = 350.0,
                  .sled_mass_kg = 2.331,
                  .normal_load_N = 22.9,
                  .was_cut_out = true,
                  .self_check = &check,
                  .scan_count = 1750};

  Sound() {
    check.raw.assign(1750, 0.0);
    check.zero_N = check.drift_N_per_s = 0.0;
    check.noise_N = 0.001;
  }
  [[nodiscard]] std::vector<std::string> findings() const {
    analysis::TestResults results;
    add_facts(facts, results);
    return base::texts_of(results.findings);
  }
};

TEST(TestFacts, OfASoundBenchAreNoFinding) { EXPECT_THAT(Sound{}.findings(), IsEmpty()); }

// A test cut out of a scanned bench has unloaded scans before it, unless somebody pulled at once; a whole
// trace or scene has none, and needs none.
TEST(TestFacts, NoSelfCheckIsAFindingOfATestCutOut) {
  Sound without;
  without.facts.self_check = nullptr;
  EXPECT_THAT(without.findings(), ElementsAre(HasSubstr("no self-check was possible: 0 unloaded scans")));
  without.facts.was_cut_out = false;
  EXPECT_THAT(without.findings(), IsEmpty());
  Sound brief;
  brief.check.raw.resize(59);
  brief.check.noise_N.reset();
  EXPECT_THAT(brief.findings(), ElementsAre(HasSubstr("59 unloaded scans before the test, 60 and 0.15 s")));
}

TEST(TestFacts, FindingsOfTheSelfCheckAreFindingsOfTheTest) {
  Sound off;
  off.check.zero_N = 0.35;  // 0.0153 of the weight, six times the limit.
  off.check.saturated_count = 1;
  EXPECT_THAT(off.findings(), ElementsAre(HasSubstr("at a rail with no load"), HasSubstr("reads 0.35 N")));
}

TEST(TestFacts, TheZeroBeforeTheTestIsOneFinding) {
  Sound off;
  off.check.zero_N = 0.35;
  off.facts.level_before = 0.0153;
  EXPECT_THAT(off.findings(), ElementsAre(HasSubstr("zero: the unloaded cell read +0.0153 before the test")));
}

// Forces are proportional to the gain, times are not; without a calibration the part is not known.
TEST(TestFacts, TheGainIsAPartOfWhatIsAForce) {
  Sound calibrated;
  for (const std::optional<double> relative : {std::optional{0.01}, std::optional<double>{}}) {
    calibrated.facts.calibration.gain_uncertainty = relative;
    analysis::TestResults results;
    results.delta_mu = analysis::Estimate::of(-0.05);
    results.omega = analysis::Estimate::of(60.0);
    add_facts(calibrated.facts, results);
    const auto part = results.delta_mu.systematic_parts[analysis::UncertaintySource::kCalibration];
    EXPECT_EQ(part.has_value(), relative.has_value());
    EXPECT_EQ(part, results.delta_mu.systematic_uncertainty);
    if (part) {
      EXPECT_DOUBLE_EQ(*part, 0.0005);
    }
    EXPECT_FALSE(results.omega.systematic_uncertainty);
  }
}

TEST(TestFacts, ScansAtARailAreCounted) {
  Sound railed;
  railed.facts.saturated_count = 7;
  EXPECT_THAT(railed.findings(), ElementsAre("the converter was at a rail in 7 of 1750 scans"));
}

// The customer's case: "500" taken as 500 kg made the gain 1000 times too large.
TEST(TestFacts, ConfirmedChangeOfTheGainIsAFinding) {
  Sound changed;
  changed.facts.calibration.gain_change = daq::gain_change(2000.0, 2.0);
  EXPECT_THAT(changed.findings(),
              ElementsAre(HasSubstr("the load cell gain 2000 N/V is 1000 times the 2 N/V in use before")));
}

TEST(TestFacts, ACalibrationCountsUntilTheMomentOfItsExpiry) {
  Sound late;
  late.facts.calibration.expires = "2026-01-01T00:00:00Z";
  late.facts.calibration.expires_ns = 1000;
  late.facts.start_realtime_ns = 999;
  EXPECT_THAT(late.findings(), IsEmpty());
  late.facts.start_realtime_ns = 1000;
  EXPECT_THAT(late.findings(),
              ElementsAre("the calibration of the load cell expired on 2026-01-01T00:00:00Z"));
  late.facts.start_realtime_ns.reset();  // Of an old replayed record nobody knows when.
  EXPECT_THAT(late.findings(), IsEmpty());
}

}  // namespace
}  // namespace stickslip::pipeline
