#include "core/record/sweep.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>

#include "core/base/contract.hpp"

namespace stickslip::record {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// \param names  model::kRegimeNames or analysis::kRungNames.
std::uint8_t index_in(const auto& names, auto value) {
  const auto* const found =
      std::find_if(names.begin(), names.end(), [&](const auto& known) { return known.first == value; });
  return static_cast<std::uint8_t>(found - names.begin());
}

/// Called with each number of a truth; NaN if there is none.
using VisitTruth = std::function<void(const FieldName&, double)>;

/// Visitor for for_each_field(): numbers only.
struct TruthNumbers {
  const VisitTruth& visit;

  void operator()(const FieldName& name, double value) const { visit(name, value); }
  void operator()(const FieldName& name, const std::optional<double>& value) const {
    visit(name, value.value_or(kNone));
  }
  void operator()(const FieldName&, const std::string&) const {}
  void operator()(const FieldName&, std::uint64_t) const {}  // The seed.
};

/// Those of the record, and two that follow from it, so that each stands beside the result of its name.
void for_each_truth(const SweepRun& run, const VisitTruth& visit) {
  for_each_field(run.truth, TruthNumbers{visit});
  visit(FieldName{"delta_mu", "1", "true S - K [1]"}, run.truth.mu_s - run.truth.mu_k);
  visit(FieldName{"cycle_count", "1", "true number of slips [1]"}, static_cast<double>(run.true_cycle_count));
}

template <typename Column>
const Column& column_of(const std::vector<Column>& columns, std::string_view name) {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const Column& column) { return column.name.name == name; });
  STICKSLIP_EXPECTS(found != columns.end());
  return *found;
}

}  // namespace

std::int64_t SweepFacts::point_count() const noexcept {
  std::int64_t count = 1;
  for (const SweepAxis& axis : axes) count *= static_cast<std::int64_t>(axis.values.size());
  return count;
}

std::vector<std::size_t> SweepFacts::indices_of(std::int64_t point) const {
  std::vector<std::size_t> indices(axes.size());
  auto rest = static_cast<std::size_t>(point);
  for (std::size_t i = axes.size(); i-- > 0;) {
    indices[i] = rest % axes[i].values.size();
    rest /= axes[i].values.size();
  }
  return indices;
}

SweepTable::SweepTable(std::int64_t run_count) {
  STICKSLIP_EXPECTS(run_count > 0);
  const auto count = static_cast<std::size_t>(run_count);
  const SweepRun none;
  analysis::for_each_result(none.results, [&](const analysis::ResultName& name, const analysis::Estimate&) {
    const std::vector<double> empty(count, kNone);
    results_.push_back({name, empty, empty, empty, std::vector<std::uint32_t>(count, 0)});
  });
  for_each_truth(none, [&](const FieldName& name, double) {
    truths_.push_back({name, std::vector<double>(count, kNone)});
  });
  regime_.resize(count);
  true_regime_.resize(count);
  rung_.resize(count);
  seed_.resize(count);
}

void SweepTable::set(const SweepRun& run) {
  STICKSLIP_EXPECTS(run.number >= 0 && run.number < static_cast<std::int64_t>(run_count()));
  const auto at = static_cast<std::size_t>(run.number);
  auto result = results_.begin();
  analysis::for_each_result(
      run.results, [&](const analysis::ResultName&, const analysis::Estimate& estimate) {
        result->value[at] = estimate.value.value_or(kNone);
        result->standard_error[at] = estimate.standard_error.value_or(kNone);
        result->systematic_uncertainty[at] = estimate.systematic_uncertainty.value_or(kNone);
        result->reason[at] = reason_index(estimate.value ? "" : estimate.reason);
        ++result;
      });
  auto truth = truths_.begin();
  for_each_truth(run, [&](const FieldName&, double value) { (truth++)->value[at] = value; });
  regime_[at] = index_in(model::kRegimeNames, run.results.regime);
  true_regime_[at] = index_in(model::kRegimeNames, run.truth.regime);
  rung_[at] = index_in(analysis::kRungNames, run.results.rung);
  seed_[at] = run.truth.seed;
}

const SweepTable::Result& SweepTable::result(std::string_view name) const {
  return column_of(results_, name);
}

const SweepTable::Truth& SweepTable::truth(std::string_view name) const { return column_of(truths_, name); }

std::uint32_t SweepTable::reason_index(const std::string& reason) {
  const auto [known, is_new] = reason_index_.try_emplace(reason, static_cast<std::uint32_t>(reasons_.size()));
  if (is_new) reasons_.push_back(reason);
  return known->second;
}

}  // namespace stickslip::record
