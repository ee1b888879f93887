// What a record says of its test comes back from JSON as it went in.

#include "daemon/types/record_result.hpp"

#include <gtest/gtest.h>

#include "io/pooled_json.hpp"
#include "io/record_name.hpp"
#include "io/results_json.hpp"
#include <nlohmann/json.hpp>

#include "core/record/record.hpp"

namespace stickslip::io {
namespace {

/// Every kind of result.
analysis::TestResults all_results() {
  analysis::TestResults results;
  results.regime = model::Regime::kMixed;
  results.regime_reason = "7 of 9 slips ended in sticking";
  results.rung = analysis::Rung::kTurningPoints;
  results.rung_reason = "the fit does not describe the test";
  results.misfit_place = "rise";
  results.findings = {base::make_finding(base::FindingCode::kPullSpeed, "the pull was slower than planned")};
  int n = 0;
  analysis::for_each_result(results, [&n](const analysis::ResultName& name, analysis::Estimate& estimate) {
    // Counts are whole.
    const double value = name.name.ends_with("_count") ? 3.0 * n : 0.1 + n / 3.0;
    switch (n++ % 4) {
      case 0:
        estimate = analysis::Estimate::of(value);
        break;
      case 1:
        estimate = analysis::Estimate::of(value, 1e-3 / n);
        break;
      case 2:
        estimate = analysis::Estimate::of(value, 1e-3 / n);
        add_systematic(estimate, static_cast<analysis::UncertaintySource>(n % 9), 2e-4 / n);
        note_no_systematic(estimate, analysis::UncertaintySource::kZero);
        break;
      default:
        estimate = analysis::Estimate::none("too few cycles");
    }
  });
  return results;
}

TEST(RecordResult, ResultsComeBackAsTheyWere) {
  const analysis::TestResults results = all_results();
  const auto text = results_json(results, true).dump();
  EXPECT_EQ(results_from_json(nlohmann::ordered_json::parse(text)), results);
  EXPECT_THROW(static_cast<void>(results_from_json(results_json(results, false))),
               nlohmann::ordered_json::exception)
      << "without details there are no reasons";
}

TEST(RecordResult, OnTheHighestRungComeBackWithoutAReason) {
  analysis::TestResults results = all_results();
  results.rung = analysis::Rung::kLawWithSlope;
  results.rung_reason.clear();
  results.misfit_place.clear();
  const nlohmann::ordered_json json = results_json(results, true);
  EXPECT_FALSE(json.at("details").contains("rung"));
  EXPECT_EQ(results_from_json(json), results);
}

TEST(RecordResult, HasTheDiagnosticsApartWithAndWithoutDetails) {
  const analysis::TestResults results = all_results();
  for (const bool with_details : {false, true}) {
    const nlohmann::ordered_json json = results_json(results, with_details);
    EXPECT_EQ(json.at("rung"), "turning-points");
    analysis::for_each_result(results, [&](const analysis::ResultName& name, const analysis::Estimate&) {
      const std::string own{name.name};
      EXPECT_EQ(json.contains(own), !name.is_diagnostic) << own;
      EXPECT_EQ(json.at("diagnostics").contains(own), name.is_diagnostic) << own;
      if (with_details) {
        EXPECT_EQ(json.at("details").contains(own), !name.is_diagnostic) << own;
      }
      if (name.is_diagnostic) {
        EXPECT_EQ(json.at("diagnostics").at(own).at("unit"), name.unit) << own;
      }
    });
  }
  const nlohmann::ordered_json details = results_json(results, true).at("details");
  EXPECT_EQ(details.at("rung").at("reason"), "the fit does not describe the test");
  EXPECT_EQ(details.at("misfit").at("place"), "rise");
}

TEST(RecordResult, OfBeforeTheRungAreRead) {
  analysis::TestResults results = all_results();
  nlohmann::ordered_json old = results_json(results, true);
  for (const auto& [name, detail] : old.at("diagnostics").items()) {
    old[name] = detail.at("value");
    old["details"][name] = detail;
  }
  for (const char* later : {"rung", "diagnostics", "mu_slope", "misfit", "smallest_slip"}) {
    old.erase(later);
    old["details"].erase(later);
  }
  results.rung = analysis::Rung::kNone;
  results.misfit_place.clear();
  results.rung_reason = record::kNoSuchResultThen;
  for (analysis::Estimate* later : {&results.mu_slope, &results.misfit, &results.smallest_slip})
    *later = analysis::Estimate::none(std::string{record::kNoSuchResultThen});
  EXPECT_EQ(results_from_json(old), results);
}

TEST(RecordResult, HasTheErrorsOfTheMainResultsWithAndWithoutDetails) {
  analysis::TestResults results;
  results.delta_mu = {0.047, 0.0027, 0.0019, ""};
  results.static_coefficient = {0.38, {}, 0.003, ""};
  results.mu_s = analysis::Estimate::of(0.35);
  results.mu_k = analysis::Estimate::none("no slip");
  const nlohmann::ordered_json brief = results_json(results, false);
  EXPECT_EQ(brief.at("uncertainties").dump(),
            R"({"static_coefficient":{"systematic_uncertainty":0.003},)"
            R"("delta_mu":{"standard_error":0.0027,"systematic_uncertainty":0.0019}})");
  for (const nlohmann::ordered_json& json : {brief, results_json(results, true)}) {
    EXPECT_EQ(estimate_in(json, "delta_mu"), results.delta_mu);
    EXPECT_EQ(estimate_in(json, "static_coefficient"), results.static_coefficient);
    EXPECT_EQ(estimate_in(json, "mu_s"), results.mu_s);
    EXPECT_FALSE(estimate_in(json, "mu_k").value);
  }
  EXPECT_EQ(estimate_in({{"delta_mu", 0.05}}, "delta_mu"), analysis::Estimate::of(0.05))
      << "of a version before";
  EXPECT_FALSE(estimate_in({{"delta_mu", "0.05"}, {"uncertainties", 3}}, "delta_mu").value);
  EXPECT_FALSE(estimate_in(nullptr, "delta_mu").value);
}

TEST(RecordResult, SumsOverSlipsComeBackAsTheyWere) {
  const analysis::SlipSums sums{.count = 9,
                                .sum = 0.45 / 3.0,
                                .square_sum = 1e-5 / 7.0,
                                .captured_count = 7,
                                .captured_sum = 0.1 / 3.0,
                                .escaped_count = 1};
  const auto text = slip_sums_json(sums).dump();
  const analysis::SlipSums again = slip_sums_from_json(nlohmann::ordered_json::parse(text));
  EXPECT_EQ(slip_sums_json(again), slip_sums_json(sums));
  EXPECT_EQ(again.sum, sums.sum);
  EXPECT_EQ(again.square_sum, sums.square_sum);
}

TEST(RecordResult, NumberStandsInTheNameOfTheRecord) {
  EXPECT_EQ(record_stem(1'795'000'000, 3), "20261118T110640Z-0003");
  for (const std::int64_t number : {1, 42, 9999, 123'456})
    EXPECT_EQ(test_number_in("2026/11/" + record_stem(1'795'000'000, number) + "-2.h5"), number);
  for (const char* name :
       {"pull.h5", "", "20261118T110640Z", "20261118T110640Z-.h5", "20261118T110640Z-0000.h5"})
    EXPECT_EQ(test_number_in(name), std::nullopt) << name;
}

TEST(RecordResult, SaysWhichFileCannotBeRead) {
  const auto test = daemon::earlier_test("/bin/false", "records/pull.h5");
  ASSERT_FALSE(test);
  EXPECT_TRUE(test.error().message.starts_with("records/pull.h5: cannot be read")) << test.error().message;
  const auto other = daemon::earlier_test("/bin/echo", "records/pull.h5");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().message, "records/pull.h5: its result is no JSON");
}

}  // namespace
}  // namespace stickslip::io
