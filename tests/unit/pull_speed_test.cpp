#include "core/model/pull_speed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stickslip::model {
namespace {

TEST(PullSpeed, IsLinesBetweenPoints) {
  const auto speed = PullSpeed::make({{0.0, 0.002}, {2.0, 0.006}, {2.0, 0.001}});
  ASSERT_TRUE(speed);
  EXPECT_EQ(speed->speed_m_per_s(-0.1), 0.0);
  EXPECT_DOUBLE_EQ(speed->speed_m_per_s(1.0), 0.004);
  EXPECT_EQ(speed->speed_m_per_s(2.0), 0.001) << "at a jump, what comes after it";
  EXPECT_EQ(speed->speed_m_per_s(50.0), 0.001);
  EXPECT_DOUBLE_EQ(speed->acceleration_m_per_s2(1.0), 0.002);
  EXPECT_EQ(speed->acceleration_m_per_s2(3.0), 0.0);
  EXPECT_DOUBLE_EQ(speed->travel_m(1.0), 0.003);
  EXPECT_DOUBLE_EQ(speed->travel_m(4.0), 0.008 + 0.002);
  EXPECT_EQ(speed->steady_until_s(1.0), 2.0);
  EXPECT_TRUE(std::isinf(speed->steady_until_s(2.0)));
  EXPECT_EQ(speed->largest_m_per_s(), 0.006);
}

TEST(PullSpeed, ASpeedWithoutDurationIsNotTheLargest) {
  EXPECT_EQ(PullSpeed::make({{0.0, 5.0}, {0.0, 1.0}})->largest_m_per_s(), 1.0);
  EXPECT_EQ(PullSpeed::make({{0.0, 1.0}, {2.0, 2.0}, {2.0, 9.0}, {2.0, 1.0}})->largest_m_per_s(), 2.0);
}

TEST(PullSpeed, PullsWhereItIsAboveZero) {
  // Forwards, to a stop in a line, back, at rest, forwards again from rest in a line.
  const auto speed = PullSpeed::make(
      {{0.0, 0.004}, {1.0, 0.004}, {3.0, -0.004}, {4.0, -0.004}, {4.0, 0.0}, {5.0, 0.0}, {6.0, 0.003}});
  ASSERT_TRUE(speed);
  ASSERT_EQ(speed->pulls().size(), 2U);
  EXPECT_EQ(speed->pulls()[0].start_s, 0.0);
  EXPECT_DOUBLE_EQ(speed->pulls()[0].end_s, 2.0);
  EXPECT_EQ(speed->pulls()[1].start_s, 5.0);
  EXPECT_TRUE(std::isinf(speed->pulls()[1].end_s));
}

// Where a line meets zero at its end no computed time may differ from that end.
TEST(PullSpeed, AZeroAtAPointMakesNoPullOfItsOwn) {
  EXPECT_FALSE(PullSpeed::make({{0.0, -0.318}, {29.93, 0.0}}));
  for (int i = 1; i < 2000; ++i) {
    const double at_s = 0.037 * i;
    const double v = 0.0031 * (i % 97 + 1);
    EXPECT_FALSE(PullSpeed::make({{0.0, -v}, {at_s, 0.0}}));
    const auto back_rest_pull = PullSpeed::make({{0.0, -v}, {at_s, 0.0}, {at_s + 1.0, 0.0}, {at_s + 1.0, v}});
    ASSERT_EQ(back_rest_pull->pulls().size(), 1U) << at_s << " " << v;
    EXPECT_EQ(back_rest_pull->pulls().front().start_s, at_s + 1.0);
    const auto touches = PullSpeed::make({{0.0, v}, {at_s, 0.0}, {2.0 * at_s, v}});
    EXPECT_EQ(touches->pulls().size(), 1U) << at_s << " " << v;
    const auto returns = PullSpeed::make({{0.0, v}, {at_s, -v}, {2.0 * at_s, -v}, {3.0 * at_s, v}});
    ASSERT_EQ(returns->pulls().size(), 2U);
    EXPECT_NEAR(returns->pulls()[0].end_s, 0.5 * at_s, 1e-12 * at_s);
    EXPECT_NEAR(returns->pulls()[1].start_s, 2.5 * at_s, 1e-12 * at_s);
  }
}

TEST(PullSpeed, TextComesBackToTheLastBit) {
  const auto speed = PullSpeed::make({{0.0, 0.1 / 3.0}, {1.0 / 7.0, 1e-300}, {2.0, 0.02}});
  ASSERT_TRUE(speed);
  const auto back = PullSpeed::parse(speed->text());
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, *speed);
}

TEST(PullSpeed, IsNoneOfWhatDoesNotPull) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(PullSpeed::make({}));
  EXPECT_FALSE(PullSpeed::make({{0.0, 0.0}, {1.0, -0.1}}));
  EXPECT_FALSE(PullSpeed::make({{0.5, 0.01}}));
  EXPECT_FALSE(PullSpeed::make({{0.0, 0.01}, {2.0, 0.02}, {1.0, 0.03}}));
  EXPECT_FALSE(PullSpeed::make({{0.0, kNan}}));
  for (const char* text : {"", "0", "0:", "0:x", "0:0.01 ", "0:0.01  1:0.02", "0:0.01,1:0.02"}) {
    EXPECT_FALSE(PullSpeed::parse(text)) << text;
  }
}

}  // namespace
}  // namespace stickslip::model
