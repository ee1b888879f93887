#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "cli/sweep/grid.hpp"

namespace stickslip::sweep {
namespace {

using record::SweepAxis;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

SweepAxis axis_of(const std::string& text) {
  const base::Result<SweepAxis> axis = parse_axis(text);
  EXPECT_TRUE(axis) << axis.error().message;
  return axis.value_or(SweepAxis{});
}

std::string refusal(const std::string& text) {
  const base::Result<SweepAxis> axis = parse_axis(text);
  if (axis) return "";
  EXPECT_EQ(axis.error().kind, base::ErrorKind::kUsage);
  EXPECT_THAT(axis.error().message, StartsWith("--vary " + text + ": "));
  return axis.error().message;
}

TEST(SweepAxis, StepsEvenlyInDecimalNumbersAsTheyWereMeant) {
  const SweepAxis axis = axis_of("paper.mu_s=0.31:0.35:5");
  EXPECT_EQ(axis.key, "paper.mu_s");
  EXPECT_EQ(axis.unit, "1");
  EXPECT_THAT(axis.values, ElementsAre(0.31, 0.32, 0.33, 0.34, 0.35));
  EXPECT_THAT(axis_of("a=0:1:4").values, ElementsAre(0.0, 0.333333333333333, 0.666666666666667, 1.0));
}

TEST(SweepAxis, BeginsAndEndsExactlyWhereItWasTold) {
  const SweepAxis axis = axis_of("a=0.1234567890123456:0.7654321098765432:7");
  EXPECT_EQ(axis.values.front(), 0.1234567890123456);
  EXPECT_EQ(axis.values.back(), 0.7654321098765432);
  EXPECT_THAT(axis_of("a=5:2:4").values, ElementsAre(5.0, 4.0, 3.0, 2.0));
  EXPECT_THAT(axis_of("a=5:2:1").values, ElementsAre(5.0));
}

TEST(SweepAxis, StepsEvenlyInLogarithms) {
  const SweepAxis axis = axis_of("accuracy=log:1e-9:1e-3:3");
  ASSERT_EQ(axis.values.size(), 3U);
  EXPECT_EQ(axis.values.front(), 1e-9);
  // exp(log) costs a few roundings, each magnified by |log| ≈ 14; then 15 digits: 1e-15 relative.
  EXPECT_NEAR(axis.values[1], 1e-6, 1e-6 * 1e-14);
  EXPECT_EQ(axis.values.back(), 1e-3);
}

TEST(SweepAxis, KeepsTheUnitThatWasAskedFor) {
  const SweepAxis axis = axis_of("effects.constant_speed.pull_speed=3 in/min:12 in/min:4");
  EXPECT_EQ(axis.unit, "in/min");
  EXPECT_THAT(axis.values, ElementsAre(3.0, 6.0, 9.0, 12.0));
  EXPECT_EQ(value_text(axis, 1), "6 in/min");
  EXPECT_EQ(axis_of("a=3:12 in/min:4"), axis_of("a=3in/min:12 in/min:4"));
  EXPECT_EQ(value_text(axis_of("a=0.1:0.3:3"), 1), "0.2");
  EXPECT_EQ(value_text(axis_of("bits=8:16:9"), 1), "9");  // A whole number stays one.
}

TEST(SweepAxis, ListsNumbersOrWords) {
  const SweepAxis numbers = axis_of("m=500 g, 2000 g,1 g");
  EXPECT_THAT(numbers.values, ElementsAre(500.0, 2000.0, 1.0));
  EXPECT_EQ(numbers.unit, "g");
  EXPECT_TRUE(numbers.words.empty());
  const SweepAxis words = axis_of("force=spring,spring-and-damper");
  EXPECT_THAT(words.values, ElementsAre(0.0, 1.0));
  EXPECT_EQ(value_text(words, 1), "spring-and-damper");
  EXPECT_THAT(axis_of("a=7").values, ElementsAre(7.0));
}

TEST(SweepAxis, RefusalsNameWhatIsWrongAndWhatIsAllowed) {
  EXPECT_THAT(refusal("a"), HasSubstr("needs a key and values"));
  EXPECT_THAT(refusal("=1,2"), HasSubstr("needs a key and values"));
  EXPECT_THAT(refusal("a="), HasSubstr("needs a key and values"));
  EXPECT_THAT(refusal("a=1:2"), HasSubstr("KEY=FROM:TO:N"));
  EXPECT_THAT(refusal("a=1:2:3:4"), HasSubstr("KEY=FROM:TO:N"));
  EXPECT_THAT(refusal("a=x:2:3"), HasSubstr("\"x\" does not begin with a decimal number"));
  EXPECT_THAT(refusal("a=1:inf:3"), HasSubstr("\"inf\" does not begin with a decimal number"));
  for (const char* count : {"0", "-1", "1.5", "many", "3 m", "100001", ""}) {
    EXPECT_THAT(refusal(std::string{"a=1:2:"} + count), HasSubstr("must be a whole number from 1 to 100000"));
  }
  EXPECT_THAT(refusal("a=1 m:2 cm:3"), HasSubstr("from \"m\" to \"cm\"; write both in one unit"));
  EXPECT_THAT(refusal("a=1 m:2:3"), HasSubstr("write both in one unit"));
  EXPECT_THAT(refusal("a=log:0:2:3"), HasSubstr("both above 0"));
  EXPECT_THAT(refusal("a=1 m,2 cm"), HasSubstr("write all values in one unit"));
  EXPECT_THAT(refusal("a=1,,2"), HasSubstr("a value is empty"));
}

TEST(SweepGrid, RefusesAKeyTwiceAndMoreRunsThanASweepMayHave) {
  const auto message = [](const std::vector<std::string>& options, std::int64_t repeat) {
    const auto axes = parse_axes(options, repeat);
    return axes ? std::string{} : axes.error().message;
  };
  EXPECT_EQ(message({"a=1:2:10", "b=1:2:10"}, 10'000), "");
  EXPECT_THAT(message({"a=1:2:10", "a=3,4"}, 1), HasSubstr("--vary a: the key comes twice"));
  EXPECT_THAT(message({"a=1:2:1000", "b=1:2:101"}, 1), HasSubstr("101000 points; a sweep may have 100000"));
  EXPECT_THAT(message({"a=1:2:10", "b=1:2:10"}, 10'001), HasSubstr("1000100 runs; a sweep may have 1000000"));
}

TEST(SweepGrid, TheLastAxisIsTheFastest) {
  record::SweepFacts facts;
  facts.axes = {axis_of("a=1,2"), axis_of("b=1,2,3")};
  facts.repeat = 5;
  EXPECT_EQ(facts.point_count(), 6);
  EXPECT_EQ(facts.run_count(), 30);
  EXPECT_THAT(facts.indices_of(0), ElementsAre(0, 0));
  EXPECT_THAT(facts.indices_of(2), ElementsAre(0, 2));
  EXPECT_THAT(facts.indices_of(3), ElementsAre(1, 0));
  EXPECT_EQ(record::SweepFacts{}.point_count(), 1);
}

}  // namespace
}  // namespace stickslip::sweep
