#include "core/daq/gain_change.hpp"

#include <gmock/gmock.h>

namespace stickslip::daq {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(GainChange, BeginsAboveAFifth) {
  EXPECT_FALSE(gain_change(2.0, 2.0));
  EXPECT_FALSE(gain_change(2.39, 2.0));
  EXPECT_FALSE(gain_change(1.61, 2.0));
  EXPECT_TRUE(gain_change(2.41, 2.0));
  EXPECT_TRUE(gain_change(1.59, 2.0));
  EXPECT_FALSE(gain_change(-2.1, -2.0));
}

TEST(GainChange, IsAChangedSign) { EXPECT_TRUE(gain_change(-2.0, 2.0)); }

TEST(GainChange, NeedsAGainBefore) {
  EXPECT_FALSE(gain_change(2.0, std::nullopt));
  EXPECT_FALSE(gain_change(2.0, 0.0));
}

TEST(GainChange, NamesBothGainsTheirRatioTheLimitAndWhatToCheck) {
  const auto change = gain_change(2000.0, 2.0);
  ASSERT_TRUE(change);
  EXPECT_EQ(change->ratio(), 1000.0);
  EXPECT_THAT(to_text(*change), AllOf(HasSubstr("2000 N/V is 1000 times the 2 N/V"),
                                      HasSubstr("more than 20 %"), HasSubstr("check the unit of each mass")));
}

}  // namespace
}  // namespace stickslip::daq
