#include "io/uncertain.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>

namespace stickslip::io {
namespace {

using analysis::Estimate;

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Estimate estimate(double value, std::optional<double> standard_error, std::optional<double> systematic) {
  return {value, standard_error, systematic, ""};
}

std::string text(double value, std::optional<double> standard_error, std::optional<double> systematic) {
  return uncertain(estimate(value, standard_error, systematic), 4).text();
}

TEST(Uncertain, HasTwoDigitsOfTheLargerError) {
  EXPECT_EQ(text(0.04698, 0.00271, 0.00188), "0.0470 ± 0.0027 ± 0.0019");
  EXPECT_EQ(text(0.04698, 0.00188, 0.0271), "0.047 ± 0.002 ± 0.027");
  EXPECT_EQ(text(0.05, 0.0003, {}), "0.05000 ± 0.00030");
  EXPECT_EQ(text(0.05, 0.00996, {}), "0.050 ± 0.010") << "rounded first: 0.0100 would be three digits";
  EXPECT_EQ(text(-0.05, 0.0012, {}), "-0.0500 ± 0.0012");
}

TEST(Uncertain, WithoutErrorsHasTheDecimalsAskedFor) {
  EXPECT_EQ(text(0.05, {}, {}), "0.0500");
  EXPECT_EQ(uncertain(Estimate::of(19.48), 3).text(), "19.480");
  EXPECT_EQ(uncertain(Estimate::of(1.234567891e-7), {}).text(), "1.23457e-07");
}

TEST(Uncertain, NamesASystematicPartThatStandsAlone) {
  EXPECT_EQ(text(0.3822, {}, 0.003), "0.3822 ± 0.0030 (syst.)");
}

TEST(Uncertain, MarksANumberThatItsErrorsTogetherExceed) {
  EXPECT_EQ(text(0.047, 0.27, {}), "0.05? ± 0.27");
  EXPECT_EQ(text(-0.047, 0.27, {}), "-0.05? ± 0.27");
  EXPECT_EQ(text(0.005, 0.004, 0.004), "0.0050? ± 0.0040 ± 0.0040") << "in quadrature 0.0057";
  EXPECT_EQ(text(0.005, 0.003, 0.004), "0.0050 ± 0.0030 ± 0.0040") << "as large as the number";
  EXPECT_EQ(text(0.0, 0.0012, {}), "0.0000? ± 0.0012");
  EXPECT_EQ(text(3.2, 120.0, 0.3), "3? ± 120 ± 0.3");
  EXPECT_FALSE(uncertain(estimate(0.047, 0.27, {}), 4).significant);
  EXPECT_TRUE(uncertain(estimate(0.047, 0.001, {}), 4).significant);
}

TEST(Uncertain, TakesNanForUnknownAndInfinityForInfinity) {
  EXPECT_EQ(text(0.05, kNan, kNan), "0.0500");
  EXPECT_EQ(text(0.05, kNan, 0.003), "0.0500 ± 0.0030 (syst.)");
  EXPECT_EQ(text(0.05, kInfinite, {}), "0.0500? ± ∞");
  EXPECT_EQ(text(0.05, 0.0012, kInfinite), "0.0500? ± 0.0012 ± ∞");
}

TEST(Uncertain, HasOneDigitOfAnErrorThatRoundsToZero) {
  EXPECT_EQ(text(0.0494, 0.000032, 0.0028), "0.0494 ± 0.00003 ± 0.0028");
  EXPECT_EQ(text(0.0494, 0.0028, 0.0000096), "0.0494 ± 0.0028 ± 0.00001");
}

TEST(Uncertain, ShowsAnErrorOfZeroAndBoundsOneBeyondTheMostDecimals) {
  EXPECT_EQ(text(0.05, 0.0, {}), "0.0500 ± 0.0000");
  EXPECT_EQ(text(0.0, 0.0, 0.0), "0.0000 ± 0.0000 ± 0.0000");
  EXPECT_EQ(text(0.3, 1e-8, 0.003), "0.3000 ± <0.000001 ± 0.0030");
  EXPECT_EQ(text(0.3, 1e-12, {}), "0.300000 ± <0.000001");
  EXPECT_EQ(uncertain(estimate(2.34e-7, 1.2e-8, {}), {}).text(), "0.000000234 ± 0.000000012");
}

TEST(Uncertain, IsADashWithoutANumber) {
  EXPECT_EQ(uncertain(Estimate::none("no slip"), 4).text(), "–");
  EXPECT_EQ(text(kNan, 0.1, {}), "–");
  EXPECT_EQ(text(kInfinite, 0.1, {}), "–");
}

TEST(Uncertain, PartsAreThoseOfTheText) {
  const Uncertain parts = uncertain(estimate(0.04698, 0.00271, 0.00188), 4);
  EXPECT_EQ(parts.value, "0.0470");
  EXPECT_EQ(parts.standard_error, "0.0027");
  EXPECT_EQ(parts.systematic, "0.0019");
}

TEST(Uncertain, ScalesValueAndErrors) {
  EXPECT_EQ(uncertain(scaled(estimate(0.00508, 0.00001, 0.00002), 1000.0), 2).text(),
            "5.080 ± 0.010 ± 0.020");
  EXPECT_EQ(uncertain(scaled(Estimate::none("no slip"), 1000.0), 2).text(), "–");
}

}  // namespace
}  // namespace stickslip::io
