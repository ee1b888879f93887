#include "report/record_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace stickslip::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kRate_Hz = 100.0;
constexpr double kSlope_per_s = 0.1;

/// 3 s of a force that rises steadily; scans 1000, 1001 …
record::Record rising_record() {
  record::Record record;
  record.header.title = "title";
  record.header.board.quantity = daq::RawQuantity::kCoefficient;
  record.header.board.scan_rate_granted_Hz = kRate_Hz;
  for (int i = 0; i < 300; ++i) {
    record.scan.push_back(1000 + i);
    record.raw.push_back(kSlope_per_s * i / kRate_Hz);
  }
  return record;
}

void add_truth(record::Record& record) {
  model::TestTruth truth;
  truth.scene_name = "scene";
  truth.omega_rad_per_s = 100.0;
  truth.gamma_over_2omega = 0.1;
  truth.modes = {{0.0, 1.0, model::Mode::kStick},
                 {1.0, 1.5, model::Mode::kSlip},
                 {1.5, 2.0, model::Mode::kStick},
                 {2.0, 2.25, model::Mode::kSlip},
                 {2.25, 3.0, model::Mode::kSlack}};
  truth.cycles = {{1.0, 0.35, 0.30}, {2.0, 0.45, 0.31}};
  record.end.emplace();
  record.end->truth = truth;
}

const plot::Curve& curve(const plot::Panel& panel, const std::string& label) {
  for (const plot::Curve& curve : panel.curves) {
    if (curve.label == label) return curve;
  }
  throw std::logic_error("no curve " + label);
}

TEST(RecordFigure, ShowsTheForceAtTimesAfterTheFirstScan) {
  const base::Result<plot::Figure> figure = record_figure(rising_record(), {});
  ASSERT_TRUE(figure) << figure.error().message;
  EXPECT_EQ(figure->title, "title");
  ASSERT_THAT(figure->panels, SizeIs(1));
  const plot::Curve& force = curve(figure->panels[0], "force at each scan");
  EXPECT_EQ(force.x.front(), 0.0);
  EXPECT_EQ(force.x.back(), 2.99);
  EXPECT_EQ(force.y.back(), kSlope_per_s * 299 / kRate_Hz);
  EXPECT_THAT(figure->panels[0].curves, SizeIs(1));  // Neither truth nor peaks are known.
  EXPECT_THAT(figure->panels[0].bands, IsEmpty());
}

TEST(RecordFigure, AGapBreaksTheLine) {
  record::Record record = rising_record();
  record.scan.erase(record.scan.begin() + 100, record.scan.begin() + 103);
  record.raw.erase(record.raw.begin() + 100, record.raw.begin() + 103);
  const plot::Figure figure = *record_figure(record, {.derivative = true});
  const plot::Curve& force = curve(figure.panels[0], "force at each scan");
  EXPECT_EQ(force.x.at(100), 1.0);
  EXPECT_TRUE(std::isnan(force.y.at(100)));
  EXPECT_EQ(force.x.at(101), 1.03);
  // No speed is made up from the two scans beside the gap.
  for (const double rate : figure.panels[1].curves[0].y) {
    if (std::isnan(rate)) continue;
    EXPECT_NEAR(rate, kSlope_per_s, 1e-12);  // 2ε · 0.3 / 0.01 s, and the distance of the scans as rounded.
  }
}

TEST(RecordFigure, TruthGivesModesAndCoefficientsOfEachSlip) {
  record::Record record = rising_record();
  add_truth(record);
  const plot::Figure figure = *record_figure(record, {});
  const plot::Panel& panel = figure.panels[0];
  ASSERT_THAT(panel.bands, SizeIs(5));
  EXPECT_EQ(panel.bands[1].shade, plot::Shade::kSlip);
  EXPECT_EQ(panel.bands[4].shade, plot::Shade::kSlack);
  // Until the next slip; the last until its end.
  EXPECT_THAT(curve(panel, "S of each slip (truth)").x, ElementsAre(1.0, 2.0, 2.0, 2.25));
  EXPECT_THAT(curve(panel, "S of each slip (truth)").y, ElementsAre(0.35, 0.35, 0.45, 0.45));
  EXPECT_THAT(curve(panel, "K of each slip (truth)").y, ElementsAre(0.30, 0.30, 0.31, 0.31));
}

TEST(RecordFigure, OnlyThePartIsShadedAndTheOverviewMarksIt) {
  record::Record record = rising_record();
  add_truth(record);
  const plot::Figure figure = *record_figure(record, {.from_s = 1.6, .to_s = 2.1, .overview = true});
  ASSERT_THAT(figure.panels, SizeIs(2));
  ASSERT_THAT(figure.panels[0].bands, SizeIs(1));
  EXPECT_EQ(figure.panels[0].bands[0].from, 1.6);
  EXPECT_EQ(figure.panels[0].bands[0].to, 2.1);
  EXPECT_EQ(figure.panels[0].own_x->range->to, 2.99);
  EXPECT_EQ(figure.x.range->from, 1.6);
  EXPECT_THAT(figure.panels[1].bands, SizeIs(2));
}

TEST(RecordFigure, ModesThatChangeTooOftenAreNotShadedAndItSaysSo) {
  record::Record record = rising_record();
  add_truth(record);
  record.end->truth->modes.clear();
  for (int i = 0; i < 1000; ++i) {
    record.end->truth->modes.push_back(
        {0.003 * i, 0.003 * (i + 1), i % 2 == 0 ? model::Mode::kStick : model::Mode::kSlip});
  }
  EXPECT_THAT(record_figure(record, {})->panels[0].bands, IsEmpty());
  EXPECT_THAT(record_figure(record, {})->notes.back(), HasSubstr("show a part"));
  EXPECT_THAT(record_figure(record, {.to_s = 0.3})->panels[0].bands, SizeIs(100));
}

// dl/dt = g/ω₀² dc/dt with ω₀² = ω² (1 + (γ/2ω)²) [7], in mm/s.
TEST(RecordFigure, DerivativeIsTheSpeedAtWhichTheCouplingStretches) {
  record::Record record = rising_record();
  add_truth(record);
  record.header.tester.gravity_m_per_s2 = 9.81;
  record.header.tester.pull_speed_m_per_s = 0.002;
  const plot::Figure figure = *record_figure(record, {.derivative = true});
  ASSERT_THAT(figure.panels, SizeIs(2));
  const double expected_mm_per_s = 1e3 * 9.81 / (1e4 * 1.01) * kSlope_per_s;
  const plot::Curve& speed = curve(figure.panels[1], "difference of neighbouring scans");
  EXPECT_EQ(speed.x.front(), 0.005);
  for (const double value : speed.y) EXPECT_NEAR(value, expected_mm_per_s, 1e-10 * expected_mm_per_s);
  EXPECT_THAT(figure.panels[1].curves.back().y, ElementsAre(2.0, 2.0));

  // The stiffness says the same without a truth: m g/k.
  record.end.reset();
  record.header.tester.sled_mass_kg = 2.0;
  record.header.tester.stiffness_N_per_m = 2.0 * 1e4 * 1.01;
  const plot::Figure measured = *record_figure(record, {.derivative = true});
  EXPECT_NEAR(measured.panels[1].curves[0].y.front(), expected_mm_per_s, 1e-10 * expected_mm_per_s);
}

TEST(RecordFigure, PeaksAreMarkedByWhatCameAfterThem) {
  record::Record record = rising_record();
  detect::Cycle cycle;
  cycle.peak_time_s = 1.0;
  cycle.peak = 0.2;
  cycle.flags = detect::kCycleCaptured;
  record.cycles = {cycle};
  cycle.peak_time_s = 2.0;
  cycle.flags = 0;
  cycle.capture_evidence = -20.0;
  record.cycles.push_back(cycle);
  cycle.peak_time_s = 3.0;
  cycle.capture_evidence = std::numeric_limits<double>::quiet_NaN();  // Scans are missing, or the pull ended.
  record.cycles.push_back(cycle);
  const plot::Figure figure = *record_figure(record, {});
  EXPECT_THAT(curve(figure.panels[0], "peak found, sticks again").x, ElementsAre(1.0));
  EXPECT_THAT(curve(figure.panels[0], "peak found, slides on").x, ElementsAre(2.0));
  EXPECT_THAT(curve(figure.panels[0], "peak found, end not seen").x, ElementsAre(3.0));
}

TEST(RecordFigure, PartsThatAreNotThereAreRefused) {
  const record::Record record = rising_record();
  for (const RecordView& view : {RecordView{.from_s = 2.99}, RecordView{.from_s = -0.1},
                                 RecordView{.to_s = 0.0}, RecordView{.from_s = 2.0, .to_s = 1.0},
                                 RecordView{.from_s = std::numeric_limits<double>::quiet_NaN()}}) {
    const base::Result<plot::Figure> figure = record_figure(record, view);
    ASSERT_FALSE(figure);
    EXPECT_EQ(figure.error().kind, base::ErrorKind::kUsage);
  }
  EXPECT_FALSE(record_figure(record::Record{}, {}));
}

}  // namespace
}  // namespace stickslip::report
