#include "core/estimate/sampling.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace stickslip::estimate {
namespace {

TEST(Sampling, RefusesBelowThreeScansACycleAndWarnsBelowEight) {
  using Kind = SamplingVerdict::Kind;
  EXPECT_EQ(check_sampling(59.9, 20.0).kind, Kind::kRefused);
  EXPECT_EQ(check_sampling(60.0, 20.0).kind, Kind::kFew);
  EXPECT_EQ(check_sampling(159.9, 20.0).kind, Kind::kFew);
  EXPECT_EQ(check_sampling(160.0, 20.0).kind, Kind::kFine);
  EXPECT_EQ(check_sampling(160.0, 20.0).reason, "");
  EXPECT_EQ(check_sampling(50.0, 20.0).reason,
            "50 scans/s are 2.5 a cycle of the expected 20 Hz: slips cannot be seen; 60 scans/s or more");
  EXPECT_EQ(check_sampling(100.0, 20.0).reason,
            "100 scans/s are 5 a cycle of the expected 20 Hz: peaks are missed; 160 scans/s or more");
}

TEST(Sampling, WithoutAPlanTheFrequencyIsNotVerifiable) {
  const SamplingVerdict verdict = check_sampling(350.0, expected_frequency_Hz(model::Tester{}, {}));
  EXPECT_EQ(verdict.kind, SamplingVerdict::Kind::kNotVerifiable);
  EXPECT_TRUE(verdict.reason.starts_with("frequency not verifiable")) << verdict.reason;
}

TEST(Sampling, ExpectsWhatWasMeasuredElseWhatTheStiffnessSays) {
  model::Tester tester;
  tester.sled_mass_kg = 2.0;
  tester.stiffness_N_per_m = 8.0 * std::numbers::pi * std::numbers::pi * 100.0;
  EXPECT_NEAR(*expected_frequency_Hz(tester, {}), 10.0, 1e-12);
  SharedPrior prior;
  prior.coupling = SharedPrior::Coupling{};
  prior.coupling->omega = 2.0 * std::numbers::pi * 20.0;
  EXPECT_NEAR(*expected_frequency_Hz(tester, prior), 20.0, 1e-12);
}

}  // namespace
}  // namespace stickslip::estimate
