#include "report/truth_table.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stickslip::report {
namespace {

TableRow row() {
  TableRow row;
  row.number = 3;
  row.results.regime = model::Regime::kStickSlip;
  row.results.static_coefficient = analysis::Estimate::of(0.38236);
  row.results.kinetic_coefficient = analysis::Estimate::none("too few cycles");
  row.results.mu_s = analysis::Estimate::of(0.35, 0.001);
  row.where = "records/3.h5";
  return row;
}

TEST(TruthTable, PutsTheTruthBelowTheMeasuredNumberAndSaysWhyOneIsAbsent) {
  TableRow with_truth = row();
  with_truth.truth.emplace();
  with_truth.truth->regime = model::Regime::kStickSlip;
  with_truth.truth->mu_s = 0.35;
  with_truth.truth->mu_k = 0.3;
  with_truth.truth->gamma_over_2omega = 0.022;
  with_truth.truth->scene_name = "scene";
  // clang-format off
  EXPECT_EQ(format_table({&with_truth, 1}),
            "test            regime           static  kinetic        S        K      S−K   f (Hz)  amplitude     γ/2ω  file, scene\n"
            "   3  measured  stick-slip       0.3824        –   0.3500        –        –        –          –        –  records/3.h5\n"
            "      truth     stick-slip            –        –   0.3500   0.3000   0.0500        –          –  0.02200  scene\n"
            "–  no kinetic in test 3: too few cycles\n");
  // clang-format on
}

TEST(TruthTable, HasOneLineForATestWhoseTruthNobodyKnows) {
  const TableRow without = row();
  const std::string table = format_table({&without, 1});
  EXPECT_EQ(table.find("truth"), std::string::npos);
  EXPECT_EQ(table.find("measured"), std::string::npos);
}

TEST(TruthTable, TellsEachReasonOnceWithItsTests) {
  std::vector<TableRow> rows{row(), row()};
  rows[1].number = 4;
  EXPECT_NE(format_table(rows).find("–  no kinetic in test 3, 4: too few cycles\n"), std::string::npos);
}

}  // namespace
}  // namespace stickslip::report
