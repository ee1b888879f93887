/// \file
/// Error and computing time of every method for one motion, compared with the best available reference.
///
///     const std::unique_ptr<base::Clock> clock = base::make_system_clock();
///     const MotionComparison table = compare_motion({motion, 350.0, 2800, 1}, shipped_methods(), *clock);
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/accuracy/method.hpp"
#include "core/base/clock.hpp"

namespace stickslip::accuracy {

/// The motion to be computed, and its sampling.
struct MotionCase {
  sim::Motion motion;
  double scan_rate_Hz = 350.0;
  std::int64_t scan_count = 0;  ///< > 0
  std::uint64_t seed = 1;
};

/// One row: a method at one setting.
struct MethodMeasurement {
  std::string method;
  std::string setting;
  /// Reason why the method cannot compute this motion, or gave up; empty: neither. If set, the numbers below
  /// mean nothing.
  std::string lacks;
  /// Largest difference of the coefficient from the reference; infinity if a value is not finite. Nullopt if
  /// `lacks` is set, and if the reference is CVODE and the values are equal to its in every bit.
  std::optional<double> largest_error;
  double ns_per_scan = 0.0;        ///< Computing time.
  std::int64_t capture_count = 0;  ///< RunOutcome::capture_count.
};

struct MotionComparison {
  std::string reference;                ///< For people.
  double reference_uncertainty = 0.0;   ///< Of its coefficient.
  std::int64_t capture_count = 0;       ///< By the reference.
  std::vector<MethodMeasurement> rows;  ///< In the order of the methods.

  /// Computing time of make_exact(); nullopt if no row has it, or if the motion has no closed form.
  [[nodiscard]] std::optional<double> exact_ns_per_scan() const;
};

/// Called from time to time with the share of the work that is done, 0 … 1.
using Progress = std::function<void(double done)>;

/// Runs and times each method (least_time_ns()). The reference has 50 digits, rounded to double, if the
/// motion allows it; its uncertainty is then that of the rounding. Otherwise it is CVODE at its smallest
/// tolerance, and its uncertainty the larger of its stated accuracy and the difference from a run with ten
/// times that tolerance. A method that gives up says so in its row.
/// \throws std::runtime_error if CVODE gives up as the reference.
[[nodiscard]] MotionComparison compare_motion(const MotionCase& motion_case,
                                              std::span<const std::unique_ptr<Method>> methods,
                                              const base::Clock& clock, const Progress& progress = {});

/// Largest |a − b| of spans of one length; infinity if a value is not finite, 0 if they are empty.
[[nodiscard]] double largest_difference(std::span<const double> a, std::span<const double> b);

}  // namespace stickslip::accuracy
