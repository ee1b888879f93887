/// \file
/// Error against time: the same motion by every method, against the best reference there is.
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

struct MotionCase {
  sim::Motion motion;
  double scan_rate_Hz = 350.0;
  std::int64_t scan_count = 0;  ///< > 0
  std::uint64_t seed = 1;
};

/// One row.
struct MethodMeasurement {
  std::string method;
  std::string setting;
  std::string lacks;  ///< Why there are no numbers; empty if there are.
  /// Largest difference of the coefficient from the reference; none for the reference itself (and what
  /// agrees with it in every bit), infinity if the method left the finite numbers.
  std::optional<double> largest_error;
  double ns_per_scan = 0.0;
  std::int64_t capture_count = 0;
};

struct MotionComparison {
  std::string reference;                ///< For people.
  double reference_uncertainty = 0.0;   ///< Of its coefficient.
  std::int64_t capture_count = 0;       ///< By the reference.
  std::vector<MethodMeasurement> rows;  ///< In the order of the methods.

  /// Of the exact closed forms; nothing if the motion has none.
  [[nodiscard]] std::optional<double> exact_ns_per_scan() const;
};

/// 0 … 1
using Progress = std::function<void(double done)>;

/// Each method is timed by least_time_ns(). The reference is in 50 digits where the motion allows; else
/// CVODE at its tightest, as uncertain as the accuracy that it has in use, and at least as it is
/// different from ten times that tolerance.
[[nodiscard]] MotionComparison compare_motion(const MotionCase& motion_case,
                                              std::span<const std::unique_ptr<Method>> methods,
                                              const base::Clock& clock, const Progress& progress = {});

/// Largest |a − b|; infinity if one of them is not finite.
[[nodiscard]] double largest_difference(std::span<const double> a, std::span<const double> b);

}  // namespace stickslip::accuracy
