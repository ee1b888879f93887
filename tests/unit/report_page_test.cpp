#include "report/report_page.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "io/table.hpp"
#include "report/assets.hpp"
#include "report/binned_trace.hpp"
#include "report/plot/looks.hpp"
#include "report/report_json.hpp"
#include "report/report_text.hpp"
#include "report/trace_json.hpp"
#include <nlohmann/json.hpp>

#include "tests/support/record_samples.hpp"
#include "tests/support/report_samples.hpp"

namespace stickslip::report {
namespace {

using ::testing::ContainsRegex;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

detect::Cycle cycle_at(double onset_s, double capture_s) {
  detect::Cycle cycle{};
  cycle.onset_time_s = onset_s;
  cycle.capture_time_s = capture_s;
  cycle.peak_time_s = onset_s;
  if (std::isfinite(capture_s)) cycle.flags = detect::kCycleCaptured;
  return cycle;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(TraceJson, HasABreakAtAGapAndEachCycle) {
  const Json trace = trace_json(test::sample_record()).value();
  EXPECT_EQ(trace["scan_count"], 40);
  EXPECT_EQ(trace["thinned"], false);
  ASSERT_EQ(trace["force"]["value"].size(), 41U);
  EXPECT_TRUE(trace["force"]["value"][20].is_null());
  EXPECT_FALSE(trace["force"]["value"][21].is_null());
  EXPECT_EQ(trace["force"]["time"].size(), 41U);
  EXPECT_EQ(trace["cycles"]["captured"], Json::array({true, false}));
  // The stiffness and the pull speed are known: the slope is a speed, with its limit.
  EXPECT_EQ(trace["slope"]["unit"], "mm/s");
  EXPECT_DOUBLE_EQ(trace["slope"]["limit"], 5.08);
}

/// "--stick: rgba(0, 158, 115, .16)" of a shade.
std::string property_of(plot::Shade shade) {
  const plot::ShadeLook look = plot::look(shade);
  const auto part = [&look](std::size_t at) {
    return std::stoi(std::string{look.colour}.substr(1 + 2 * at, 2), nullptr, 16);
  };
  return fmt::format("--{}: rgba({}, {}, {}, .{:.0f})", look.label, part(0), part(1), part(2),
                     100.0 * look.opacity);
}

TEST(Colours, OfStickAndSlipAreTheSameInPicturesAndOnPages) {
  EXPECT_THAT(std::string{colours_css()}, HasSubstr(property_of(plot::Shade::kStick)));
  EXPECT_THAT(std::string{colours_css()}, HasSubstr(property_of(plot::Shade::kSlip)));
  EXPECT_THAT(std::string{report_css()}, Not(HasSubstr("--stick:")));
}

TEST(BinnedTrace, ABinIsTheSameNumberOfIndicesAndOneWithoutScansIsNull) {
  const record::Record record = test::sample_record();
  const Json whole = binned_trace_json(record, {}).value();
  EXPECT_EQ(whole["scans_in_bin"], 1);
  const auto indices = static_cast<std::size_t>(record.scan.back() - record.scan.front() + 1);
  ASSERT_GT(indices, record.scan.size());  // There is a gap.
  ASSERT_EQ(whole["lowest"].size(), indices);
  EXPECT_TRUE(whole["lowest"][20].is_null());
  EXPECT_EQ(whole["lowest"][19], whole["highest"][19]);
  const Json four = binned_trace_json(record, {.bins = 4}).value();
  EXPECT_EQ(four["scans_in_bin"], (indices - 1) / 4 + 1);
  EXPECT_LT(four["lowest"][0], four["highest"][0]);
  // To the scan, from any time between the one before and it.
  const double rate_Hz = record.header.board.scan_rate_granted_Hz;
  const Json part = binned_trace_json(record, {.from_s = 2.5 / rate_Hz, .to_s = 5.5 / rate_Hz}).value();
  EXPECT_EQ(part["lowest"], Json::array({whole["lowest"][3], whole["lowest"][4], whole["lowest"][5]}));
}

TEST(BinnedTrace, RefusesWhatIsNotInTheRecord) {
  const record::Record record = test::sample_record();
  const auto why = [&record](const TraceSpan& span) {
    return binned_trace_json(record, span).error().message;
  };
  EXPECT_THAT(why({.from_s = 1000.0}), testing::HasSubstr("the end of the record"));
  EXPECT_THAT(why({.from_s = 0.01, .to_s = 0.01}), testing::HasSubstr("must be above 0.01 s"));
  EXPECT_THAT(why({.from_s = 1e-4, .to_s = 2e-4}), testing::HasSubstr("there is no scan"));
  EXPECT_THAT(why({.bins = 0}), testing::HasSubstr("must be 1 or more"));
}

TEST(TraceJson, HasTheSecondChannelWithABreakWhereNoCodeCame) {
  const record::Record record = test::sample_record();
  const Json second = trace_json(record).value()["second"];
  EXPECT_EQ(second["name"], "pull_speed");
  EXPECT_EQ(second["unit"], "mm/s");
  ASSERT_EQ(second["value"].size(), 41U);  // 40 scans and the gap behind 20 of them.
  EXPECT_TRUE(second["value"][7].is_null());
  EXPECT_TRUE(second["value"][20].is_null());
  // To the millionth of a mm/s.
  EXPECT_NEAR(second["value"][21], 1e3 * record.header.board.second->value(2000), 0.5e-6);
  EXPECT_TRUE(trace_json(test::sample_imported()).value()["second"].is_null());
}

TEST(TraceJson, SlopeWithoutStiffnessIsARateWithoutALimit) {
  const Json trace = trace_json(test::sample_imported()).value();
  EXPECT_EQ(trace["slope"]["unit"], "1/s");
  EXPECT_TRUE(trace["slope"]["limit"].is_null());
  // sin(0.1 i)/3 at 2 kHz begins with a slope of 0.1/3 · 2000 Hz, less i²/6 of it.
  EXPECT_NEAR(trace["slope"]["value"][0], 0.1 / 3.0 * 2000.0, 0.002 * 0.1 / 3.0 * 2000.0);
  // Equal steps of time; the slope is that between two scans.
  EXPECT_FALSE(trace["force"].contains("time"));
  EXPECT_EQ(trace["force"]["start"], 0.0);
  EXPECT_NEAR(trace["force"]["step"], 1.0 / 2000.0, 1e-12);
  EXPECT_NEAR(trace["slope"]["start"], 0.5 / 2000.0, 1e-12);
}

TEST(TraceJson, ModesGoFromSlipToStickToSlip) {
  record::Record record = test::sample_imported();
  record.cycles = {cycle_at(0.001, 0.002), cycle_at(0.004, kNone), cycle_at(0.006, kNone)};
  record.end->results.regime = model::Regime::kStickSlip;
  const Json sticking = trace_json(record).value()["modes"];
  // Of the last slip of a test that sticks nobody knows how it would have ended.
  EXPECT_EQ(sticking,
            Json::array({{0.001, 0.002, "slip"}, {0.002, 0.004, "stick"}, {0.004, 0.006, "slide"}}));
  // That of a ring-down goes on while the force is at least half of its largest: to the last of 20 scans.
  record.end->results.regime = model::Regime::kMixed;
  const Json mixed = trace_json(record).value()["modes"];
  ASSERT_EQ(mixed.size(), 4U);
  EXPECT_EQ(mixed[3], Json::array({0.006, 0.0095, "slide"}));
  record.end->results.regime = model::Regime::kInertialOscillation;
  EXPECT_EQ(trace_json(record).value()["modes"], mixed);
}

TEST(TraceJson, RecordWithoutLoadCellIsRefused) {
  record::Record record = test::sample_record();
  record.header.load_cell.reset();
  ASSERT_FALSE(trace_json(record));
  EXPECT_EQ(trace_json(record).error().exit_status(), 2);
}

TEST(JsonForScript, CannotEndItsElement) {
  const Json json{{"title", "</script><!--<script>\xff"}};
  const std::string text = json_for_script(json);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(text)["title"], "</script><!--<script>\uFFFD");
}

TEST(ReportText, ShowsMeansReasonsAndDepartures) {
  const std::string text = report_text(test::sample_material());
  EXPECT_THAT(text, HasSubstr("group 1: 12 in/min, undecided, 3 tests\n"));
  EXPECT_THAT(text, HasSubstr("0.385 ± 0.064"));  // t(0.975, 1) · 0.00707/√2 = 12.706 · 0.005
  EXPECT_THAT(text, HasSubstr("–  no static in test 3: not asked\n"));
  EXPECT_THAT(text, HasSubstr("!  test 3: pull speed is other\n"));
  EXPECT_THAT(text, HasSubstr("method: own kinetic_cycles=3\n"));
}

// 0.38 and 0.39: s/√2 = 0.005. Two tests are within ± 2 by Student's t in 70 % of all cases.
TEST(ReportText, HasAnUncertaintyBudgetOfEachGroup) {
  const std::string text = report_text(test::sample_material());
  EXPECT_THAT(text, HasSubstr("\nuncertainty budget of these means\n"));
  EXPECT_THAT(text, ::testing::ContainsRegex("\nreplicates +A +0.0050  100\n"));
  EXPECT_THAT(text, ::testing::ContainsRegex("\nexpanded, U = 2 u +0.010\n"));
  EXPECT_THAT(text,
              HasSubstr("static = 0.385 ± 0.010 (k = 2), without calibration, zero; so few tests that it\n"
                        "   covers 70 %, not 95 %\n"));
  EXPECT_THAT(text,
              HasSubstr("–  calibration: no uncertainty of the gain: hang weights, stickslip calibrate\n"));
  std::istringstream lines{text.substr(text.find("uncertainty budget"))};
  for (std::string line; std::getline(lines, line);) EXPECT_LE(io::display_width(line), 80U) << line;
}

TEST(ReportText, HasNoBudgetOfWhatHasNoValue) {
  Material material = test::sample_material();
  for (analysis::MeasuredTest& test : material.measured)
    test.results.static_coefficient = analysis::Estimate::none("not asked");
  material.groups = analysis::group_by_speed(material.measured);
  EXPECT_THAT(report_text(material), Not(HasSubstr("budget")));
}

TEST(ReportJson, HasTheBudgetsOfTestsAndGroups) {
  Material material = test::sample_material();
  analysis::Estimate& measured = material.measured[0].results.static_coefficient;
  add_systematic(measured, analysis::UncertaintySource::kCalibration, 0.003);
  material.groups = analysis::group_by_speed(material.measured);
  const Json json = report_json(material);
  const Json& own = json.at("tests").at(0).at("budgets");
  EXPECT_TRUE(own.at("delta_mu").is_null());
  EXPECT_EQ(own.at("static_coefficient").at("combined_standard_uncertainty"), 0.003);
  EXPECT_EQ(own.at("static_coefficient").at("expanded_uncertainty"), 0.006);
  EXPECT_EQ(own.at("static_coefficient").at("coverage_factor"), 2.0);
  const Json& group = json.at("groups").at(0).at("budgets").at("static_coefficient");
  const auto line = std::ranges::find_if(
      group.at("lines"), [](const Json& other) { return other.at("source") == "calibration"; });
  ASSERT_NE(line, group.at("lines").end());
  EXPECT_EQ(line->at("state"), "counted");
  EXPECT_EQ(line->at("standard_uncertainty"), 0.003);
  EXPECT_NEAR(line->at("share").get<double>(), 9.0 / (9.0 + 25.0), 1e-9);
  EXPECT_THAT(line->at("note").get<std::string>(), HasSubstr("not known in 1 of 2 tests"));
  EXPECT_THAT(report_csv(material),
              HasSubstr("delta_mu_expanded_uncertainty,static_coefficient_expanded_uncertainty,"
                        "kinetic_coefficient_expanded_uncertainty"));
}

TEST(FormBlock, NamesWhatDiffersAndWhatNoRecordStates) {
  Material material = test::sample_material();
  constexpr std::size_t kGrade = 2;
  constexpr std::size_t kOperator = 11;
  const char* const operators[] = {"Ann", "Bo", ""};
  for (std::size_t i = 0; i < 3; ++i) {
    material.tests[i].facts[kGrade] = "liner";
    material.tests[i].facts[kOperator] = operators[i];
  }
  const std::string text = report_text(material);
  EXPECT_THAT(text, HasSubstr("grade            liner\n"));
  EXPECT_THAT(text, HasSubstr("operator         2 operators: Ann; Bo; not stated in 1 of 3\n"));
  EXPECT_THAT(text, HasSubstr("conditioning     –\n"));
  EXPECT_THAT(text, HasSubstr("n                3\n"));
  EXPECT_THAT(text,
              HasSubstr("verdict          no limits were stated; 1 of 3 tests not as the method asks\n"));
  material.limits.push_back({.quantity = "mu_k", .limits = {}, .outside = {}, .absent = {}});
  EXPECT_THAT(verdict_of(material), HasSubstr("PASS, within 1 limit"));
  material.limits.front().outside = {1};
  EXPECT_THAT(verdict_of(material), HasSubstr("FAIL, 1 of 1 limit not kept"));
}

TEST(FormBlock, TakesFromARecordWhatItStatesAndNothingElse) {
  record::RecordHeader header;
  for (const std::string& fact : facts_of(header, "")) EXPECT_EQ(fact, "");
  header.tester.sled_mass_kg = 0.2;
  header.sample.metadata["Contact time"] = "15 s";
  header.sample.metadata["conditioning"] = "23 °C, 50 %";
  header.load_cell.emplace();
  header.load_cell->gain_N_per_V = 2.5;
  header.calibration.date = "2026-11-20T10:00:00+00:00";
  const RecordFacts facts = facts_of(header, "100 mm/min");
  EXPECT_THAT(facts, ::testing::Contains("200 g"));
  EXPECT_THAT(facts, ::testing::Contains("15 s"));
  EXPECT_THAT(facts, ::testing::Contains("23 °C, 50 %"));
  EXPECT_THAT(facts, ::testing::Contains("2.5 N/V, of 2026-11-20"));
  EXPECT_THAT(facts, ::testing::Contains("100 mm/min"));
  header.sample.metadata["temperature"] = "23.1 degC";
  EXPECT_THAT(facts_of(header, ""), ::testing::Contains("23.1 degC"));
  header.sample.metadata["humidity"] = "52 %";
  header.sample.metadata["lot"] = "4711";
  EXPECT_THAT(facts_of(header, ""), ::testing::Contains("23.1 degC, 52 %"));
  EXPECT_THAT(facts_of(header, ""), ::testing::Contains("4711"));
}

TEST(Comparison, RefusesASideOfTwoGradesUnlessTheyArePooled) {
  Material material = test::sample_material();
  EXPECT_TRUE(check_one_grade(material, "A"));
  material.tests[2].sample.grade = "liner";
  EXPECT_THAT(check_one_grade(material, "A").error().message,
              HasSubstr("A: f0.h5 has no grade, f2.h5 has grade \"liner\": name the records of one grade, or "
                        "--pool grades"));
  material.pooling.grades = true;
  EXPECT_TRUE(check_one_grade(material, "A"));
}

TEST(ReportCsv, HasAColumnForEachFactThatAnyTestStatesAndOneForItsNumber) {
  Material material = test::sample_material();
  EXPECT_THAT(report_csv(material), Not(HasSubstr("fact.")));
  material.tests[1].sample.metadata = {{"temperature", "73.4 degF"}, {"humidity", "dry"}, {"room", "2"}};
  const std::string csv = report_csv(material);
  const std::string heading = csv.substr(0, csv.find_first_of("\r\n"));
  EXPECT_THAT(heading, EndsWith(",fact.humidity,fact.room,fact.temperature,temperature_degC,humidity_ratio"));
  // An older record may hold a humidity that is no number.
  EXPECT_THAT(csv, ContainsRegex(",dry,2,73.4 degF,23(.0+[0-9]+)?,\r?\n"));
  EXPECT_THAT(csv, ContainsRegex(",,,,,\r?\n"));
}

TEST(ReportCsv, HasTheRungAndNoDiagnostics) {
  Material material = test::sample_material();
  material.measured[0].results.rung = analysis::Rung::kLawWithSlope;
  const std::string csv = report_csv(material);
  EXPECT_THAT(csv, HasSubstr(",regime,rung,transition_time,"));
  EXPECT_THAT(csv, HasSubstr(",undecided,law-with-slope,"));
  EXPECT_THAT(csv, HasSubstr(",mu_slope,misfit,smallest_slip,"));
  EXPECT_THAT(csv, Not(HasSubstr("delta_mu_combined")));
}

TEST(ReportPage, HoldsEachPartOnceAndNoMark) {
  const std::string page =
      report_page(test::sample_material(), {"const uPlot", ".uplot {}", "The MIT License"});
  for (const char* mark : {"@LICENSE@", "@UPLOT_CSS@", "@COLOURS_CSS@", "@REPORT_CSS@", "@DATA@", "@TRACES@",
                           "@UPLOT_JS@", "@UNCERTAIN_JS@", "@CHARTS_JS@", "@REPORT_JS@"}) {
    EXPECT_EQ(page.find(mark), std::string::npos) << mark;
  }
  EXPECT_THAT(page, HasSubstr("The MIT License"));
  EXPECT_THAT(page, HasSubstr("const Charts"));
  EXPECT_THAT(page, HasSubstr("uPlot"));
  EXPECT_TRUE(page.starts_with("<!DOCTYPE html>"));
  EXPECT_TRUE(page.ends_with("</html>\n"));
}

TEST(ReportPage, HoldsTheTraceOfEachTestOfBothMaterials) {
  Material a = test::sample_material();
  a.tests.front().trace = R"({"scan_count":1})";
  Material b = test::sample_material();
  b.tests.back().trace = R"({"scan_count":2})";
  const std::string page = comparison_page(a, b, compare_materials(a, b), {"", "", ""});
  EXPECT_THAT(page, HasSubstr("id=\"trace-0-0\">{\"scan_count\":1}</script>"));
  EXPECT_THAT(page,
              HasSubstr(fmt::format("id=\"trace-1-{}\">{{\"scan_count\":2}}</script>", b.tests.size() - 1)));
}

}  // namespace
}  // namespace stickslip::report
