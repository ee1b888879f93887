#include "core/base/digits.hpp"

#include <gtest/gtest.h>

namespace stickslip::base {
namespace {

TEST(Digits, DecimalsShowSoManySignificantDigitsOfTheRoundedNumber) {
  EXPECT_EQ(decimals_of(0.00271, 2), 4);
  EXPECT_EQ(decimals_of(0.00996, 2), 3);  // 0.010
  EXPECT_EQ(decimals_of(12.3, 2), 0);
  EXPECT_EQ(decimals_of(123.0, 2), -1);
}

TEST(Digits, ASpeedHasTheUnitInWhichItIsShortest) {
  EXPECT_EQ(speed_text(12 * 0.0254 / 60), "12 in/min");
  EXPECT_EQ(speed_text(0.00508), "12 in/min");
  EXPECT_EQ(speed_text(0.1 / 60), "100 mm/min");
  EXPECT_EQ(speed_text(0.15 / 60), "150 mm/min");
  EXPECT_EQ(speed_text(0.001), "1 mm/s");
  EXPECT_EQ(speed_text(1.0), "1 m/s");
  EXPECT_EQ(speed_text(0.0), "0 in/min");
  EXPECT_EQ(unit_of_speed(0.1 / 60).text(0.00508), "304.8 mm/min");
}

}  // namespace
}  // namespace stickslip::base
