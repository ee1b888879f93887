#include "report/truth_table.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/table.hpp"

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
  EXPECT_EQ(format_table({&with_truth, 1}),
            " test  regime         S−K       S       K  static  kinetic  file, scene\n"
            "    3  stick-slip       –  0.3500       –  0.3824        –  records/3.h5\n"
            "       ± stat.             0.0010\n"
            "truth  stick-slip  0.0500  0.3500  0.3000       –        –  scene\n"
            "± stat.  standard error: less with more slips or more tests\n"
            "truth    what was simulated\n"
            "–  no kinetic in test 3: too few cycles\n");
}

TEST(TruthTable, PutsBothErrorsBelowTheNumberWithTheirPointsAligned) {
  std::vector<TableRow> rows(2);
  rows[0].number = 1;
  rows[0].results.regime = model::Regime::kStickSlip;
  rows[0].results.delta_mu = {0.04698, 0.00271, 0.00188, ""};
  rows[0].results.mu_s = {0.3512, 0.003, 0.004, ""};
  rows[0].results.mu_k = {0.3042, 0.00012, 0.0031, ""};
  rows[0].results.static_coefficient = {0.3822, {}, 0.003, ""};
  rows[0].results.kinetic_coefficient = analysis::Estimate::of(0.302);
  rows[0].where = "m_paper_k168_v42.h5";
  rows[1] = rows[0];
  rows[1].number = 2;
  rows[1].results.delta_mu = {0.0199, 0.034, 0.0021, ""};
  rows[1].results.mu_k = {0.3001, 0.00012, {}, ""};
  const std::string table = format_table(rows);
  EXPECT_EQ(table,
            "test  regime         S−K       S        K  static  kinetic  file, scene\n"
            "   1  stick-slip  0.0470  0.3512  0.3042   0.3822   0.3020  m_paper_k168_v42.h5\n"
            "      ± stat.     0.0027  0.0030  0.0001\n"
            "      ± syst.     0.0019  0.0040  0.0031   0.0030\n"
            "   2  stick-slip  0.020?  0.3512  0.30010  0.3822   0.3020  m_paper_k168_v42.h5\n"
            "      ± stat.     0.034   0.0030  0.00012\n"
            "      ± syst.     0.002   0.0040           0.0030\n"
            "± stat.  standard error: less with more slips or more tests\n"
            "± syst.  systematic part (calibration, corrections): the same each time\n"
            "?  not significant, its errors together exceed it: S−K in test 2\n");
}

TEST(TruthTable, FitsATerminalOf80ColumnsWithFilesBelowTheNumbers) {
  std::vector<TableRow> rows{row(), row()};
  rows[1].number = 4;
  for (TableRow& one : rows) {
    one.where = "records/demo/20261127T123529Z-0001.h5";
    one.truth.emplace().scene_name = "ring-down-at-12-in-per-min";
  }
  const std::string table = format_table(rows);
  EXPECT_NE(table.find("file of test 3: records/demo/20261127T123529Z-0001.h5\n"), std::string::npos);
  EXPECT_NE(table.find("scene of test 3, 4: ring-down-at-12-in-per-min\n"), std::string::npos);
  for (std::size_t at = 0; at < table.size(); at = table.find('\n', at) + 1)
    EXPECT_LE(io::display_width(table.substr(at, table.find('\n', at) - at)), 80U);
}

TEST(TruthTable, HasNoLegendOfWhatDoesNotOccur) {
  TableRow without = row();
  without.results.mu_s = analysis::Estimate::of(0.35);
  const std::string table = format_table({&without, 1});
  EXPECT_EQ(table.find("±"), std::string::npos);
  EXPECT_EQ(table.find('?'), std::string::npos);
}

TEST(TruthTable, HasNoTruthForATestWhoseTruthIsUnknown) {
  const TableRow without = row();
  EXPECT_EQ(format_table({&without, 1}).find("truth"), std::string::npos);
}

TEST(TruthTable, TellsEachReasonOnceWithItsTests) {
  std::vector<TableRow> rows{row(), row()};
  rows[1].number = 4;
  EXPECT_NE(format_table(rows).find("–  no kinetic in test 3, 4: too few cycles\n"), std::string::npos);
}

}  // namespace
}  // namespace stickslip::report
