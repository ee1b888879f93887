/// \file
/// The pull speed, or the hold, at which one more test would tell most about what the tests so far cannot
/// tell.
#pragma once

#include <optional>
#include <span>

#include "core/law/friction_law.hpp"

namespace stickslip::law {

/// Speeds of the tester; from < to.
struct SpeedRange {
  double from_m_per_s = 0.0;
  double to_m_per_s = 0.0;
};

struct NextPull {
  double pull_speed_m_per_s = 0.0;
  std::optional<double>
      hold_s;  ///< The belt stands still for so long in that pull; absent: a pull without a hold.
  bool tells_ageing = false;  ///< Else the rate.
  /// The smallest dependence that matters, in standard errors of the slope after this pull; 0 where too few
  /// tests tell the errors.
  double separation = 0.0;
};

/// Longest hold that is asked of a technician.
inline constexpr double kLongestHold_s = 100.0;

/// A third of the slowest speed of the tests to three times the fastest.
[[nodiscard]] SpeedRange usual_range(std::span<const LawTest> tests);

/// About S if it cannot be told and a pull in the range sticks, else about K. Not about what its systematic
/// part alone keeps from being told. A hold of kLongestHold_s is asked only where
/// tests have holds.
/// \param found  of these tests. \param highest_sticking_m_per_s  above it the sled does not stick again, so
/// that S says nothing; absent: unknown. \return nullopt if no pull in the range would tell more.
[[nodiscard]] std::optional<NextPull> next_pull(const FrictionLaw& found, std::span<const LawTest> tests,
                                                const SpeedRange& range,
                                                std::optional<double> highest_sticking_m_per_s);

}  // namespace stickslip::law
