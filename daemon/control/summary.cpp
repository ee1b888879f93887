#include "daemon/control/summary.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "io/or_null.hpp"
#include "io/pooled_json.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/grouping.hpp"
#include "core/analysis/quantities.hpp"
#include "core/analysis/replicates.hpp"
#include "daemon/types/verdict.hpp"

namespace stickslip::control {
namespace {

using Json = nlohmann::ordered_json;

struct Counted {
  std::vector<std::int64_t> numbers;
  std::vector<analysis::MeasuredTest> tests;
};

Counted counted(std::span<const daemon::TestSummary> tests, const daemon::BatchBook& book,
                const std::function<std::string(const std::string&)>& name_of) {
  Counted result;
  const daemon::Batch* const batch = book.current();
  for (const daemon::TestSummary& test : tests) {
    const std::string name = test.file.empty() ? std::string{} : name_of(test.file);
    if (!name.empty() && book.voided(name) != nullptr) continue;
    const auto is_it = [&name](const daemon::BatchTest& own) { return own.record == name; };
    // A test of the batch stands in the journal once its record is there.
    if (batch != nullptr && std::none_of(batch->tests.begin(), batch->tests.end(), is_it)) continue;
    result.numbers.push_back(test.number);
    result.tests.push_back({std::nullopt, test.results, test.slips});
  }
  return result;
}

Json quantity_json(const analysis::Quantity& quantity, const Counted& counted) {
  std::vector<double> values;
  std::vector<std::int64_t> numbers;
  for (std::size_t i = 0; i < counted.tests.size(); ++i) {
    const analysis::Estimate& estimate = counted.tests[i].results.*quantity.estimate;
    if (!estimate.value) continue;
    values.push_back(*estimate.value);
    numbers.push_back(counted.numbers[i]);
  }
  Json json{{"name", quantity.name}, {"unit", quantity.unit}, {"count", values.size()}};
  for (const char* key : {"mean", "standard_deviation", "repeatability", "mean_low", "mean_high", "lowest",
                          "highest", "outlier_test"})
    json[key] = nullptr;
  if (values.empty()) return json;
  const analysis::Replicates all = analysis::describe_replicates(values);
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  json["mean"] = all.mean;
  json["standard_deviation"] = io::or_null(all.standard_deviation);
  json["repeatability"] = io::or_null(all.repeatability);
  if (all.mean_interval) {
    json["mean_low"] = all.mean_interval->low;
    json["mean_high"] = all.mean_interval->high;
  }
  json["lowest"] = *lowest;
  json["highest"] = *highest;
  if (all.outlier) json["outlier_test"] = numbers[all.outlier->index];
  return json;
}

Json verdict_json(const daemon::LimitVerdict& verdict, const Counted& counted) {
  const auto numbers = [&counted](const std::vector<std::size_t>& indices) {
    Json list = Json::array();
    for (const std::size_t i : indices) list.push_back(counted.numbers[i]);
    return list;
  };
  return {{"quantity", verdict.quantity},
          {"lowest", io::or_null(verdict.limits.lowest)},
          {"highest", io::or_null(verdict.limits.highest)},
          {"passes", verdict.passes()},
          {"outside", numbers(verdict.outside)},
          {"absent", numbers(verdict.absent)}};
}

}  // namespace

Json summary_json(std::span<const daemon::TestSummary> tests, const daemon::BatchBook& book,
                  const std::function<std::string(const std::string&)>& name_of) {
  const Counted those = counted(tests, book, name_of);
  const daemon::Batch* const batch = book.current();
  Json quantities = Json::array();
  for (const analysis::Quantity& quantity : analysis::quantities())
    quantities.push_back(quantity_json(quantity, those));
  std::vector<const analysis::MeasuredTest*> measured;
  for (const analysis::MeasuredTest& test : those.tests) measured.push_back(&test);
  Json limits = Json::array();
  if (batch != nullptr) {
    for (const auto& [quantity, own] : batch->plan.limits)
      limits.push_back(verdict_json(daemon::judged(quantity, own, those.tests), those));
  }
  return {{"batch", batch == nullptr ? Json(nullptr) : Json(batch->id)},
          {"tests", those.numbers},
          {"delta_mu_by_cycle", io::pooled_json(analysis::pool_tests(measured))},
          {"quantities", std::move(quantities)},
          {"limits", std::move(limits)}};
}

}  // namespace stickslip::control
