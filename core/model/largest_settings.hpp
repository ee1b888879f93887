/// \file
/// Largest accepted settings of a paper friction tester. A larger value is taken for a mistake in a unit.
#pragma once

namespace stickslip::model {

inline constexpr double kHeaviestSled_kg = 1000.0;
inline constexpr double kFastestPull_m_per_s = 10.0;

}  // namespace stickslip::model
