/// \file
/// The largest values that settings of a paper friction tester may have; what is larger is a mistake in a
/// unit.
#pragma once

namespace stickslip::model {

inline constexpr double kHeaviestSled_kg = 1000.0;
inline constexpr double kFastestPull_m_per_s = 10.0;

}  // namespace stickslip::model
