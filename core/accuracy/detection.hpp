/// \file
/// Error of S − K and computing time per cycle of each estimator of a test. A new estimator implements
/// Estimator and is added to shipped_estimators().
///
///     const std::vector<DetectionRow> rows = compare_estimators(test, shipped_estimators(), *clock);
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/accuracy/comparison.hpp"
#include "core/analysis/test_analysis.hpp"
#include "core/base/clock.hpp"
#include "core/base/scan_index.hpp"
#include "core/model/truth.hpp"

namespace stickslip::accuracy {

/// One test, input of the estimators, with its truth.
struct ObservedTest {
  analysis::AnalysisSettings settings;  ///< Rate > 0, A/D step, tester, method; no speed_step_m_per_s.
  std::vector<base::ScanIndex> scan;    ///< Rises; a jump is a gap.
  std::vector<double> coefficient;      ///< One for each scan; finite.
  std::vector<bool> saturated;          ///< One for each scan.
  model::TestTruth truth;

  /// Mean S − K of the slips that began from sticking; nullopt if there were none.
  [[nodiscard]] std::optional<double> true_delta_mu() const;
};

/// Estimates S − K from a whole test. Stateless. Thread-safe.
class Estimator {
 public:
  virtual ~Estimator() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// Setting of the estimator; empty if it has none.
  [[nodiscard]] virtual std::string setting() const = 0;
  /// S − K of the whole test, or the reason for its absence; must not use the truth.
  [[nodiscard]] virtual analysis::Estimate delta_mu(const ObservedTest& test) const = 0;
};

/// The instrument's own estimator: analysis::TestAnalysis, with turning points where the fit does not
/// describe the test.
[[nodiscard]] std::unique_ptr<Estimator> make_whole_test_fit();
/// The traditional estimator: static less kinetic coefficient by the test's method, by default the first peak
/// less the mean of the ten cycles after it.
[[nodiscard]] std::unique_ptr<Estimator> make_traditional_difference();

[[nodiscard]] std::vector<std::unique_ptr<Estimator>> shipped_estimators();

struct DetectionRow {
  std::string estimator;
  std::string setting;
  std::string reason;                  ///< Why there is no estimate; empty if there is.
  std::optional<double> error;         ///< Estimate less truth, of S − K; nullopt unless both exist.
  std::optional<double> us_per_cycle;  ///< Computing time over the true cycles; nullopt without any.
};

/// Runs and times (least_time_ns()) each estimator: a row for each, in their order.
[[nodiscard]] std::vector<DetectionRow> compare_estimators(
    const ObservedTest& test, std::span<const std::unique_ptr<Estimator>> estimators,
    const base::Clock& clock);

}  // namespace stickslip::accuracy
