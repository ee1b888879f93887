/// \file
/// Limits for figures of a random sample, derived from its size. A right program is beyond a limit with
/// probability `false_alarm`. Seeds of tests are fixed, so a test is drawn anew only where the code changes.
#pragma once

namespace stickslip::test {

/// Of one limit, unless a test says another.
inline constexpr double kFalseAlarm = 1e-4;

/// Highest value of (mean of n squares of standard normal numbers); its root limits an rms.
[[nodiscard]] double highest_mean_square(double n, double false_alarm = kFalseAlarm);

/// Lowest value of the same.
[[nodiscard]] double lowest_mean_square(double n, double false_alarm = kFalseAlarm);

/// Distance of a mean of n values from the truth, in sample standard deviations of one value; both sides.
[[nodiscard]] double farthest_mean(double n);

/// Highest count among n if each counts with probability `share`, 0 < share < 1.
[[nodiscard]] double highest_count(double n, double share, double false_alarm = kFalseAlarm);

/// Lowest count.
[[nodiscard]] double lowest_count(double n, double share);

}  // namespace stickslip::test
