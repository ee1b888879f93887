/// \file
/// The pull speed, or the hold, at which one more test would tell most of what the tests so far leave open.
#pragma once

#include <optional>
#include <span>

#include "core/law/friction_law.hpp"

namespace stickslip::law {

/// Range of pull speeds from which next_pull() chooses; 0 < from < to.
struct SpeedRange {
  double from_m_per_s = 0.0;
  double to_m_per_s = 0.0;
};

/// The pull that would tell most.
struct NextPull {
  double pull_speed_m_per_s = 0.0;
  /// The belt stands still for so long in that pull; absent: a pull without a hold.
  std::optional<double> hold_s;
  bool tells_ageing = false;  ///< It would tell about S; else about K.
  /// The smallest slope that matters, in standard errors of the slope after this pull; > 0.
  double separation = 0.0;
};

/// The hold that is asked for, the longest that a technician will wait.
inline constexpr double kLongestHold_s = 100.0;

/// A third of the slowest speed of the tests to three times the fastest. \param tests  at least one.
[[nodiscard]] SpeedRange usual_range(std::span<const LawTest> tests);

/// The pull that would tell most about S if S cannot be told; about K if that cannot, and S is told or no
/// pull would tell it. Not asked about: a coefficient that no test has, and what the systematic part alone
/// keeps from being told. A hold of kLongestHold_s is asked for only where tests have holds, at the speed of
/// the first of these, whatever the range.
/// \param found  of these tests.
/// \param highest_sticking_m_per_s  above it the sled does not stick again, so that S says nothing; pulls
/// about S without a hold are at most 0.8 of it. If the whole range lies above that, S is asked about with a
/// hold only. Absent: unknown, no limit.
/// \return nullopt if there is nothing to ask about, if slope_that_matters is 0, if no pull in the range
/// would tell anything, and where the tests show a direct effect of rate-and-state friction
/// (!RateAndState::may_have_none).
[[nodiscard]] std::optional<NextPull> next_pull(const FrictionLaw& found, std::span<const LawTest> tests,
                                                const SpeedRange& range,
                                                std::optional<double> highest_sticking_m_per_s);

}  // namespace stickslip::law
