// The shipped scenes, with the random numbers they name, give the results kept in expected/. A change
// that moves a number shows here first. To keep the new ones, after looking at the difference:
//
//     STICKSLIP_REBUILD_GOLDEN=1 ./dev test     # then commit tests/golden/expected

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "tests/support/scene_tests.hpp"

namespace stickslip {
namespace {

using nlohmann::ordered_json;

ordered_json measured(const std::filesystem::path& scene) {
  const std::vector<test::AnalysedTest> tests = test::analyse_scene(scene, 1);
  if (tests.size() != 1) throw std::runtime_error("one test expected");
  const test::AnalysedTest& test = tests.front();
  ordered_json object;
  object["first"] = test.first;
  object["trigger"] = test.trigger;
  object["end"] = test.end;
  object["results"] = io::results_json(test.results, true);
  for (const detect::Cycle& cycle : test.cycles) {
    object["cycles"].push_back(
        {{"first_scan", cycle.first_scan}, {"flags", cycle.flags}, {"peak", cycle.peak}});
  }
  return object;
}

/// Across processors glibc rounds sin, cos and exp differently in the last bit. The fit stops where its cost
/// changes by less than 1e-10 of itself, so an estimate may move by √1e-10 of its standard error for each of
/// some hundred scans: 1e-3 standard errors. Numbers without one are sums and interpolations: 1e-9.
double tolerance(const ordered_json& detail) {
  const double value = detail.at("value").is_null() ? 0.0 : detail.at("value").get<double>();
  return 1e-3 * detail.value("standard_error", 0.0) + 1e-9 * std::max(1.0, std::abs(value));
}

class ExpectedResults : public testing::TestWithParam<const char*> {};

TEST_P(ExpectedResults, AreMeasuredAgain) {
  const std::filesystem::path source{STICKSLIP_SOURCE_DIR};
  const std::filesystem::path file = source / "tests/golden/expected" / (std::string{GetParam()} + ".json");
  const ordered_json now = measured(source / "config/scenes" / (std::string{GetParam()} + ".toml"));
  if (std::getenv("STICKSLIP_REBUILD_GOLDEN") != nullptr) {
    std::ofstream{file} << now.dump(1) << '\n';
    GTEST_SKIP() << "rebuilt " << file;
  }
  std::ifstream stream{file};
  ASSERT_TRUE(stream) << file << " is missing: see the head of this test";
  const ordered_json expected = ordered_json::parse(stream);

  for (const char* exact : {"first", "trigger", "end"}) EXPECT_EQ(now.at(exact), expected.at(exact)) << exact;
  for (const char* word : {"regime", "rung"})
    EXPECT_EQ(now.at("results").at(word), expected.at("results").at(word)) << word;
  for (const char* part : {"details", "diagnostics"}) {
    const ordered_json& details = expected.at("results").at(part);
    ASSERT_EQ(now.at("results").at(part).size(), details.size());
    for (const auto& [name, detail] : details.items()) {
      if (!detail.contains("value")) continue;  // A word with its reason.
      const ordered_json& other = now.at("results").at(part).at(name);
      ASSERT_EQ(other.at("value").is_null(), detail.at("value").is_null()) << name;
      if (detail.at("value").is_null()) continue;
      if (name.find("count") != std::string::npos) {
        EXPECT_EQ(other.at("value"), detail.at("value")) << name;
      } else {
        EXPECT_NEAR(other.at("value").get<double>(), detail.at("value").get<double>(), tolerance(detail))
            << name;
      }
    }
  }
  ASSERT_EQ(now.at("cycles").size(), expected.at("cycles").size());
  for (std::size_t i = 0; i < expected.at("cycles").size(); ++i) {
    const ordered_json& cycle = expected.at("cycles").at(i);
    EXPECT_EQ(now.at("cycles").at(i).at("first_scan"), cycle.at("first_scan")) << i;
    EXPECT_EQ(now.at("cycles").at(i).at("flags"), cycle.at("flags")) << i;
    EXPECT_NEAR(now.at("cycles").at(i).at("peak").get<double>(), cycle.at("peak").get<double>(), 1e-9) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(ShippedScenes, ExpectedResults,
                         testing::Values("ring-down-at-12-in-per-min", "stick-slip-at-12-in-per-min"));

}  // namespace
}  // namespace stickslip
