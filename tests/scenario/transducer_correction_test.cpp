// A pull that is read through a load cell that rings or a slow filter: told the transducer, the fit finds the
// truth within its own errors. The simulator's transducer is exact and shares no code with that of the fit.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "core/analysis/test_analysis.hpp"
#include "core/base/sanitized.hpp"
#include "tests/support/plain_pull.hpp"

namespace stickslip::analysis {
namespace {

constexpr double kS = 0.35;
constexpr double kK = 0.30;
constexpr double kOmega = 2.0 * std::numbers::pi * 20.0;

struct Case {
  const char* name;
  model::Transducer transducer;
  std::string effect;
};

const Case kCell{"cell",
                 {model::LoadCellDynamics{120.0, 0.05}, {}},
                 "[effects.load_cell]\nfrequency = \"120 Hz\"\ndamping_ratio = 0.05\n"};
const Case kFilter{"filter",
                   {{}, model::AntiAlias{60.0, 4}},
                   "[effects.anti_alias]\nkind = \"butterworth\"\ncutoff = \"60 Hz\"\norder = 4\n"};
const Case kBoth{
    "both",
    {kCell.transducer.load_cell, model::AntiAlias{100.0, 3}},
    kCell.effect + "[effects.anti_alias]\nkind = \"butterworth\"\ncutoff = \"100 Hz\"\norder = 3\n"};

std::vector<double> pulled(const Case& seen, double pull_s, std::uint64_t seed) {
  return test::PlainPull{.K = kK, .delta_mu = kS - kK, .pull_s = pull_s, .effects = seen.effect, .seed = seed}
      .coefficients();
}

TestResults analysed(const std::vector<double>& values, const AnalysisSettings& settings) {
  TestAnalysis analysis{settings};
  for (std::size_t k = 0; k < values.size(); ++k)
    analysis.add(static_cast<base::ScanIndex>(k), values[k], false);
  return analysis.finish();
}

AnalysisSettings told(const model::Transducer& transducer) {
  AnalysisSettings settings;
  settings.scan_rate_Hz = test::PlainPull::kRate_Hz;
  settings.tester.pull_speed_m_per_s = 12.0 * 0.0254 / 60.0;
  settings.tester.transducer = transducer;
  return settings;
}

bool has_finding(const TestResults& results, base::FindingCode code) {
  for (const base::Finding& finding : results.findings)
    if (finding.code == base::kind_of(code).name) return true;
  return false;
}

double z_of(const Estimate& estimate, double truth) {
  return (*estimate.value - truth) / *estimate.standard_error;
}

class ThroughATransducer : public testing::TestWithParam<Case> {};

TEST_P(ThroughATransducer, TheTruthIsFoundWithinTheErrorsOfTheFit) {
  for (std::uint64_t seed = 1; seed <= (base::kSanitized ? 1 : 2); ++seed) {
    const std::vector<double> values = pulled(GetParam(), 4.0, seed);
    const TestResults unknown = analysed(values, told({}));
    ASSERT_TRUE(unknown.delta_mu.value);
    // Untold, S - K is off by many of its errors, and the finding says so.
    EXPECT_GT(std::abs(z_of(unknown.delta_mu, kS - kK)), 4.0);
    EXPECT_TRUE(has_finding(unknown, base::FindingCode::kMisfit));
    const TestResults known = analysed(values, told(GetParam().transducer));
    EXPECT_FALSE(has_finding(known, base::FindingCode::kTransducerShows));
    ASSERT_TRUE(known.delta_mu.standard_error && known.mu_k.standard_error);
    for (const auto& [name, estimate, truth] :
         {std::tuple{"S - K", known.delta_mu, kS - kK}, std::tuple{"K", known.mu_k, kK},
          std::tuple{"omega", known.omega, kOmega},
          std::tuple{"gamma/2omega", known.gamma_over_2omega, 0.022}}) {
      std::printf("%s, seed %d: %s z %+.2f\n", GetParam().name, static_cast<int>(seed), name,
                  z_of(estimate, truth));
      EXPECT_LT(std::abs(z_of(estimate, truth)), 4.0) << name << ", seed " << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, ThroughATransducer, testing::Values(kCell, kFilter, kBoth),
                         [](const testing::TestParamInfo<Case>& seen) {
                           return std::string{seen.param.name};
                         });

// More slips than errors are learnt from, columns in a file.
TEST(TransducerCorrection, OfALongTestIsTheSameFromAFile) {
  const std::vector<double> values = pulled(kCell, 12.0, 3);
  AnalysisSettings settings = told(kCell.transducer);
  const TestResults in_memory = analysed(values, settings);
  settings.scratch_folder = std::filesystem::temp_directory_path();
  settings.live = false;
  const TestResults from_file = analysed(values, settings);
  EXPECT_GT(*in_memory.cycle_count.value, 200.0);
  EXPECT_LT(std::abs(z_of(in_memory.delta_mu, kS - kK)), 4.0);
  EXPECT_EQ(in_memory.delta_mu.value, from_file.delta_mu.value);
  EXPECT_EQ(in_memory.delta_mu.standard_error, from_file.delta_mu.standard_error);
}

// A filter whose lag is longer than a fifth of an oscillation, and an estimator without a fit.
TEST(TransducerCorrection, ThatIsNotPossibleIsTold) {
  const std::vector<double> values = pulled(kCell, 3.0, 4);
  const TestResults too_slow = analysed(values, told({{}, model::AntiAlias{5.0, 4}}));
  EXPECT_TRUE(has_finding(too_slow, base::FindingCode::kTransducerShows));
  AnalysisSettings settings = told(kCell.transducer);
  settings.estimator = detect::EstimatorTier::kTurningPoints;
  EXPECT_TRUE(has_finding(analysed(values, settings), base::FindingCode::kTransducerShows));
  EXPECT_FALSE(has_finding(analysed(values, told({})), base::FindingCode::kTransducerShows));
}

// The filter hides a part of the slips also from a fit that knows the tester's damping.
TEST(TransducerCorrection, WidensTheErrorsOfATestWithACharacterisedTesterToo) {
  const std::vector<double> values = pulled(kFilter, 4.0, 5);
  AnalysisSettings settings = told(kFilter.transducer);
  settings.prior.coupling =
      estimate::SharedPrior::Coupling{kOmega, 0.022, Eigen::Vector2d{0.01, 1e-6}.asDiagonal()};
  const TestResults known = analysed(values, settings);
  settings.tester.transducer = {};
  const TestResults unknown = analysed(values, settings);
  ASSERT_TRUE(known.mu_k.standard_error && unknown.mu_k.standard_error);
  EXPECT_LT(std::abs(z_of(known.mu_k, kK)), 4.0);
  EXPECT_LT(std::abs(z_of(known.delta_mu, kS - kK)), 4.0);
  EXPECT_GT(*known.mu_k.standard_error, 1.5 * *unknown.mu_k.standard_error);
}

}  // namespace
}  // namespace stickslip::analysis
