#include "core/accuracy/detection.hpp"

#include "core/accuracy/least_time.hpp"
#include "core/base/contract.hpp"

namespace stickslip::accuracy {
namespace {

using analysis::Estimate;

analysis::TestResults analysed(const ObservedTest& test) {
  analysis::TestAnalysis analysis{test.settings};
  for (std::size_t i = 0; i < test.scan.size(); ++i) {
    if (i > 0 && test.scan[i] != test.scan[i - 1] + 1)
      analysis.gap(test.scan[i - 1] + 1, test.scan[i] - test.scan[i - 1] - 1);
    analysis.add(test.scan[i], test.coefficient[i], test.saturated[i]);
  }
  return analysis.finish();
}

class WholeTestFit final : public Estimator {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "fit of the whole test"; }
  [[nodiscard]] std::string setting() const override { return {}; }
  [[nodiscard]] Estimate delta_mu(const ObservedTest& test) const override { return analysed(test).delta_mu; }
};

class TraditionalDifference final : public Estimator {
 public:
  [[nodiscard]] std::string_view name() const noexcept override { return "traditional static less kinetic"; }
  [[nodiscard]] std::string setting() const override { return {}; }
  [[nodiscard]] Estimate delta_mu(const ObservedTest& test) const override {
    const analysis::TestResults results = analysed(test);
    if (!results.static_coefficient.value) return results.static_coefficient;
    if (!results.kinetic_coefficient.value) return results.kinetic_coefficient;
    return Estimate::of(*results.static_coefficient.value - *results.kinetic_coefficient.value);
  }
};

}  // namespace

std::optional<double> ObservedTest::true_delta_mu() const {
  if (truth.cycles.empty()) return std::nullopt;
  double sum = 0.0;
  for (const model::TrueCycle& cycle : truth.cycles) sum += cycle.mu_s - cycle.mu_k;
  return sum / static_cast<double>(truth.cycles.size());
}

std::unique_ptr<Estimator> make_whole_test_fit() { return std::make_unique<WholeTestFit>(); }
std::unique_ptr<Estimator> make_traditional_difference() { return std::make_unique<TraditionalDifference>(); }

std::vector<std::unique_ptr<Estimator>> shipped_estimators() {
  std::vector<std::unique_ptr<Estimator>> estimators;
  estimators.push_back(make_whole_test_fit());
  estimators.push_back(make_traditional_difference());
  return estimators;
}

std::vector<DetectionRow> compare_estimators(const ObservedTest& test,
                                             std::span<const std::unique_ptr<Estimator>> estimators,
                                             const base::Clock& clock) {
  STICKSLIP_EXPECTS(test.coefficient.size() == test.scan.size());
  STICKSLIP_EXPECTS(test.saturated.size() == test.scan.size());
  constexpr double kNanosecondsPerMicrosecond = 1e3;
  const std::optional<double> truth = test.true_delta_mu();
  std::vector<DetectionRow> rows;
  for (const std::unique_ptr<Estimator>& estimator : estimators) {
    Estimate estimate;
    const std::int64_t time_ns = least_time_ns(clock, [&] { estimate = estimator->delta_mu(test); });
    DetectionRow row{std::string{estimator->name()}, estimator->setting(), estimate.reason, {}, {}};
    if (estimate.value && truth) row.error = *estimate.value - *truth;
    if (!test.truth.cycles.empty()) {
      row.us_per_cycle = static_cast<double>(time_ns) / kNanosecondsPerMicrosecond /
                         static_cast<double>(test.truth.cycles.size());
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace stickslip::accuracy
