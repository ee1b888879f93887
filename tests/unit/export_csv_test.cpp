// The table for spreadsheets: what stands in it beside the force. That its numbers come back to the last
// digit is seen from outside (system_export).

#include "io/export_csv.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

#include "tests/support/record_samples.hpp"

namespace stickslip::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream text{line};
  for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  return fields;
}

/// Without the facts: header first.
std::vector<std::vector<std::string>> table_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream text{csv};
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with('#')) rows.push_back(fields_of(line));
  }
  return rows;
}

TEST(ExportCsv, HasTheSecondChannelWhereTheRecordHasOne) {
  const record::Record record = test::sample_record();
  const daq::SecondChannel& channel = *record.header.board.second;
  const std::string csv = scans_csv(record);
  EXPECT_THAT(csv, HasSubstr("\n# pull_speed_gain: 0.0021 m/s/V\n"));
  EXPECT_THAT(csv, HasSubstr("\n# pull_speed_zero: 0.05 V\n"));
  const auto rows = table_of(csv);
  ASSERT_EQ(rows.size(), 41U);
  EXPECT_THAT(rows[0], ElementsAre("time_s", "scan", "counts", "voltage_V", "force_N", "coefficient",
                                   "pull_speed_counts", "pull_speed_m_per_s", "spike", "saturated"));
  EXPECT_EQ(rows[4][6], "300");
  EXPECT_EQ(rows[4][7], fmt::format("{}", channel.value(300)));
  // The code of the eighth scan did not arrive.
  EXPECT_EQ(rows[8][6], "");
  EXPECT_EQ(rows[8][7], "");
  EXPECT_EQ(rows[8].size(), rows[0].size());
}

TEST(ExportCsv, HasTheRungAndNoDiagnosticsAmongItsFacts) {
  const std::string csv = scans_csv(test::sample_record());
  EXPECT_THAT(csv, HasSubstr("\n# rung: two-parameter-law\n"));
  EXPECT_THAT(csv, HasSubstr("\n# mu_slope: "));
  EXPECT_THAT(csv, Not(HasSubstr("\n# delta_mu_combined: ")));
}

TEST(ExportCsv, NamesAPositionInMetres) {
  record::Record record = test::sample_record();
  record.header.board.second->quantity = daq::SecondQuantity::kSledPosition;
  const auto header = table_of(scans_csv(record)).front();
  EXPECT_EQ(header[6], "sled_position_counts");
  EXPECT_EQ(header[7], "sled_position_m");
}

TEST(ExportCsv, HasNoSuchColumnsWithoutASecondChannel) {
  const auto header = table_of(scans_csv(test::sample_imported())).front();
  EXPECT_THAT(header, ElementsAre("time_s", "scan", "coefficient", "spike", "saturated"));
}

}  // namespace
}  // namespace stickslip::io
