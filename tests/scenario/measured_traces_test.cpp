/// Traces of a real tester, paper on paper: one setting of the analysis for all of them.
/// They lie beside the project (STICKSLIP_SHARED_DATA names another place) and are required if CI=true.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "core/friction/test_analysis.hpp"

namespace stickslip::friction {
namespace {

/// The source of the traces says so; their t_s column too.
constexpr double kScanRate_Hz = 2000.0;

std::filesystem::path data_folder() {
  const char* named = std::getenv("STICKSLIP_SHARED_DATA");
  if (named != nullptr && *named != '\0') return named;
  return std::filesystem::path(STICKSLIP_SOURCE_DIR) / ".." / "shared" / "data";
}

bool required() {
  const char* ci = std::getenv("CI");
  return ci != nullptr && std::string{ci} == "true";
}

std::vector<double> second_column(const std::filesystem::path& file) {
  std::ifstream stream{file};
  std::vector<double> values;
  std::string line;
  std::getline(stream, line);  // names of the columns
  while (std::getline(stream, line)) values.push_back(std::stod(line.substr(line.find(',') + 1)));
  return values;
}

class MeasuredTraces : public testing::Test {
 protected:
  /// Reads and analyses; no results if the file is absent: a failure where it is required.
  std::optional<TestResults> analyse(const std::string& name) {
    const std::filesystem::path file = data_folder() / name;
    if (!std::filesystem::exists(file)) {
      if (required()) {
        ADD_FAILURE() << file << " is required";
      }
      return std::nullopt;
    }
    AnalysisSettings settings;
    settings.scan_rate_Hz = kScanRate_Hz;
    TestAnalysis analysis{settings};
    base::ScanIndex index = 0;
    for (const double value : second_column(file)) analysis.add(index++, value, false);
    return analysis.finish();
  }
};

TEST_F(MeasuredTraces, NearlySinusoidalStickSlip) {
  // Counted by eye: 131 cycles of 27.5–30 ms.
  const auto results = analyse("paper_k1002_v4300.csv");
  if (!results) GTEST_SKIP() << "there are no measured traces in " << data_folder();
  RecordProperty("cycles", std::to_string(*results->cycle_count.value));
  RecordProperty("period_s", std::to_string(*results->period_median.value));
  RecordProperty("regime", std::string(name(results->regime)) + ": " + results->regime_reason);
  EXPECT_NEAR(results->cycle_count.value.value(), 131.0, 0.03 * 131.0);
  EXPECT_NEAR(results->period_median.value.value(), 0.0285, 0.02 * 0.0285);
}

TEST_F(MeasuredTraces, SawTooth) {
  // Counted by eye: 39 slips, seven of them of a third of the usual drop.
  const auto results = analyse("paper_k168_v42.csv");
  if (!results) GTEST_SKIP() << "there are no measured traces in " << data_folder();
  RecordProperty("cycles", std::to_string(*results->cycle_count.value));
  RecordProperty("regime", std::string(name(results->regime)) + ": " + results->regime_reason);
  EXPECT_NEAR(results->cycle_count.value.value(), 39.0, 2.0);
}

TEST_F(MeasuredTraces, IrregularSlidingHasNoCycles) {
  const auto results = analyse("paper_k2254_v42.csv");
  if (!results) GTEST_SKIP() << "there are no measured traces in " << data_folder();
  EXPECT_EQ(results->cycle_count.value, 0.0);
  EXPECT_EQ(results->regime, Regime::kSteadySliding);
  EXPECT_FALSE(results->period_median.value);
}

}  // namespace
}  // namespace stickslip::friction
