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
/// Between pulls t is as 1/v, so that they tell b − a alone; holds at one speed tell b. This holds for a sled
/// far softer than critical, and pulls so slow that the time of a slip does not matter: docs/friction-laws.md
/// has what simulated tests find.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/law/line.hpp"

namespace stickslip::law {

struct LawTest;

struct RateAndState {
  Parameter a;
  Parameter b;
  double critical_slip_m = 0.0;  ///< D_c at a and b as found.
  double within_factor = 0.0;    ///< D_c is known within it: what the closed form leaves open, and a and b.
  /// a exceeds its 99 % interval and its systematic part, b and b − a exceed their 95 % intervals.
  bool is_told = false;
  bool may_have_none = true;             ///< a does not exceed its 95 % interval and its systematic part.
  double between_variance = 0.0;         ///< Between pulls, of S.
  std::vector<std::optional<double>> S;  ///< Of each test by the law; nullopt where it counts for nothing.
};

/// What the closed form leaves open, by simulated tests: D_c within this factor, as it takes contacts for new
/// within no way at all and is the exponential of the drop over b; and a within this part of it.
inline constexpr double kCriticalSlipFactor = 5.0;
inline constexpr double kDirectEffectPart = 0.3;

/// b by the slopes of S over log₁₀ t within sheets with holds, each of which has a level of its own; b − a by
/// the slope between the other pulls; a by their difference. S of a hold is its S − K on the K of usual
/// slips: less (b − a) ln of how much larger its S − K is. Pulls whose time at rest is not long beside the
/// time of a slip are left out. \param points  S over log₁₀ of the stick time. \param of_tests  index of the
/// test of each point. \return nullopt without a sheet with holds, without three slow pulls at two speeds, or
/// without a degree of freedom for b.
[[nodiscard]] std::optional<RateAndState> rate_and_state(std::span<const LawTest> tests,
                                                         std::span<const Point> points,
                                                         std::span<const std::size_t> of_tests);

}  // namespace stickslip::law
