/// \file
/// The same question for detection: how far from the truth is S − K, and what does a cycle cost? An estimator
/// takes part by filling Estimator and standing in shipped_estimators().
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

/// One test as an estimator sees it, and what it should find.
struct ObservedTest {
  analysis::AnalysisSettings settings;  ///< Rate, A/D step, tester, method.
  std::vector<base::ScanIndex> scan;    ///< Rises; a jump is a gap.
  std::vector<double> coefficient;      ///< One for each scan.
  std::vector<bool> saturated;          ///< One for each scan.
  model::TestTruth truth;

  /// Mean S − K of the slips that began by giving way; nothing if there were none.
  [[nodiscard]] std::optional<double> true_delta_mu() const;
};

/// Stateless. Thread-safe.
class Estimator {
 public:
  virtual ~Estimator() = default;

  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  [[nodiscard]] virtual std::string setting() const = 0;
  /// S − K of the whole test; without the truth, of course.
  [[nodiscard]] virtual analysis::Estimate delta_mu(const ObservedTest& test) const = 0;
};

/// What the instrument does: analysis::TestAnalysis, scan by scan, with the fit of the whole test at its end.
[[nodiscard]] std::unique_ptr<Estimator> make_whole_test_fit();
/// What the tradition has: first peak less the mean of the cycles that follow.
[[nodiscard]] std::unique_ptr<Estimator> make_traditional_difference();

[[nodiscard]] std::vector<std::unique_ptr<Estimator>> shipped_estimators();

struct DetectionRow {
  std::string estimator;
  std::string setting;
  std::string reason;                  ///< Why there is no estimate; empty if there is.
  std::optional<double> error;         ///< Estimate less truth, of S − K.
  std::optional<double> us_per_cycle;  ///< None if the truth has no cycle.
};

/// Timed as compare_motion() does.
[[nodiscard]] std::vector<DetectionRow> compare_estimators(
    const ObservedTest& test, std::span<const std::unique_ptr<Estimator>> estimators,
    const base::Clock& clock);

}  // namespace stickslip::accuracy
