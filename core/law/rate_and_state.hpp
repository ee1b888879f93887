/// \file
/// Rate-and-state friction from pulls at several speeds and slips after holds [Dieterich, J. Geophys. Res.
/// 84(B5):2161–2168, 1979; Ruina, J. Geophys. Res. 88(B12):10359–10370, 1983]:
///
///     μ = μ₀ + a ln(V/V₀) + b ln(V₀ θ/D_c)
///
/// A slip begins as the sled reaches the belt's speed v, after a rest of t = θ; while it slips at up to
/// V = (S − K) g/ω₀, θ is D_c/V:
///
///     S = const + a ln v + b ln t,    S − K(V) = b ln(V t/D_c) − a ln(V/v),    K = const − (b − a) ln V
///
/// Between pulls t is as 1/v, so that they tell b − a alone; holds at one speed tell b. This holds for a
/// stiffness far below the critical one of the law, and pulls so slow that the time of a slip does not
/// matter: docs/friction-laws.md has what simulated tests find.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/law/line.hpp"

namespace stickslip::law {

struct LawTest;

/// Parameters of the law, with what the tests tell of it.
struct RateAndState {
  Parameter a;                   ///< Direct effect; of natural logarithms.
  Parameter b;                   ///< Ageing; of natural logarithms.
  double critical_slip_m = 0.0;  ///< D_c at a and b as found; may be infinite or NaN unless `is_told`.
  /// D_c lies between critical_slip_m over and times this factor, by what the closed form leaves open
  /// (kCriticalSlipFactor) and the 95 % intervals of b and b − a. At least kCriticalSlipFactor; may be
  /// infinite, or NaN unless `is_told`.
  double within_factor = 0.0;
  /// Whether the law is told: a exceeds its 99 % interval, b and b − a exceed their 95 % intervals, each with
  /// the systematic part of the values, and D_c is finite. a must do so with and without the correction for
  /// the lower K of slips after holds.
  bool is_told = false;
  /// Whether there may be no direct effect: with or without that correction, a does not exceed its 95 %
  /// interval with the systematic part of the values.
  bool may_have_none = true;
  double between_variance = 0.0;  ///< Variance of S between pulls, beyond their own errors.
  /// S of each test by the law, in the order of the tests, to be compared with LawTest::S; nullopt for a test
  /// that is not used.
  std::vector<std::optional<double>> S;
};

/// D_c by the closed form is right within this factor, by simulated tests: the form neglects the way on which
/// contacts become new, and D_c is the exponential of the drop over b.
inline constexpr double kCriticalSlipFactor = 5.0;
/// a by the closed form is right within this part of itself, by simulated tests. Its systematic part has it.
inline constexpr double kDirectEffectPart = 0.3;

/// Finds b by one slope of S over log₁₀ t within the sheets with holds, each of which has a level of its own;
/// b − a by the slope between the pulls of other sheets; a by their difference.
///
/// A slip after a hold is faster than a usual one, so that its K is lower by (b − a) ln of the ratio of their
/// S − K; its S, which was taken on the K of usual slips, is less by as much. Of the other sheets, pulls that
/// rest for less than five times the duration of a slip, or have no S above K, are left out.
///
/// \param points  S over log₁₀ of the stick time in s. \param of_tests  index of the test of each point.
/// \return nullopt without a sheet with holds, without three slow pulls of other sheets at two stick times,
/// or without a degree of freedom for b.
[[nodiscard]] std::optional<RateAndState> rate_and_state(std::span<const LawTest> tests,
                                                         std::span<const Point> points,
                                                         std::span<const std::size_t> of_tests);

}  // namespace stickslip::law
