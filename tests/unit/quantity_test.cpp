#include "core/base/quantity.hpp"

#include <gtest/gtest.h>

namespace stickslip::base {
namespace {

struct Good {
  const char* text;
  Dimension dimension;
  double si;
};

class QuantityIsRead : public testing::TestWithParam<Good> {};

// Equal to the last bit: each factor is a quotient of two exact numbers, applied in this order.
TEST_P(QuantityIsRead, InSiUnits) {
  const Result<double> value = parse_quantity(GetParam().text, GetParam().dimension);
  ASSERT_TRUE(value) << value.error().message;
  EXPECT_EQ(*value, GetParam().si);
}

INSTANTIATE_TEST_SUITE_P(
    Units, QuantityIsRead,
    testing::Values(
        Good{"12 in/min", Dimension::kSpeed, 12 * 0.0254 / 60}, Good{"2331 g", Dimension::kMass, 2.331},
        Good{"2331g", Dimension::kMass, 2.331}, Good{"  2.331 kg ", Dimension::kMass, 2.331},
        Good{"1 lb", Dimension::kMass, 0.45359237}, Good{"20 Hz", Dimension::kFrequency, 20},
        Good{"0.5 s", Dimension::kTime, 0.5}, Good{"2 min", Dimension::kTime, 120},
        Good{"10 V", Dimension::kVoltage, 10}, Good{"-5e-3 V", Dimension::kVoltage, -5e-3},
        Good{"250 µV", Dimension::kVoltage, 250e-6}, Good{"1.5 N/V", Dimension::kForcePerVoltage, 1.5},
        Good{"1 kgf", Dimension::kForce, 9.80665}, Good{"1000 gf", Dimension::kForce, 9.80665},
        Good{"1 lbf/in", Dimension::kStiffness, 4.4482216152605 / 0.0254},
        Good{"5 in", Dimension::kLength, 0.127}, Good{"25 in^2", Dimension::kArea, 0.016129},
        Good{"40 cm²", Dimension::kArea, 0.004}, Good{"3 mm/s", Dimension::kSpeed, 3e-3},
        Good{"1 %", Dimension::kDimensionless, 0.01}, Good{"0.35", Dimension::kDimensionless, 0.35},
        Good{"9.8 m/s²", Dimension::kAcceleration, 9.8},
        Good{"180 deg", Dimension::kAngle, 3.14159265358979323846},
        Good{"2 rad/s", Dimension::kAngularFrequency, 2}, Good{"60 1/min", Dimension::kPerTime, 1}));

struct Bad {
  const char* text;
  Dimension dimension;
  const char* error;
};

class QuantityIsRefused : public testing::TestWithParam<Bad> {};

TEST_P(QuantityIsRefused, NamingTheValueAndWhatIsAllowed) {
  const Result<double> value = parse_quantity(GetParam().text, GetParam().dimension);
  ASSERT_FALSE(value) << *value;
  EXPECT_EQ(value.error().kind, ErrorKind::kUsage);
  EXPECT_EQ(value.error().message, GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    Mistakes, QuantityIsRefused,
    testing::Values(
        Bad{"12", Dimension::kMass, "\"12\" has no unit; allowed: kg, g, mg, lb"},
        Bad{"12 Kg", Dimension::kMass, "\"12 Kg\" has the unit \"Kg\"; allowed: kg, g, mg, lb"},
        Bad{"12 in/min", Dimension::kMass, "\"12 in/min\" has the unit \"in/min\"; allowed: kg, g, mg, lb"},
        Bad{"3 V", Dimension::kDimensionless, "\"3 V\" has the unit \"V\"; allowed: no unit, %, ppm"},
        Bad{"", Dimension::kVoltage,
            "\"\" does not begin with a decimal number; write a number and one of: V, mV, uV"},
        Bad{"V", Dimension::kVoltage,
            "\"V\" does not begin with a decimal number; write a number and one of: V, mV, uV"},
        Bad{"nan V", Dimension::kVoltage,
            "\"nan V\" does not begin with a decimal number; write a number and one of: V, mV, uV"},
        Bad{"inf V", Dimension::kVoltage,
            "\"inf V\" does not begin with a decimal number; write a number and one of: V, mV, uV"},
        Bad{"+1 V", Dimension::kVoltage,
            "\"+1 V\" does not begin with a decimal number; write a number and one of: V, mV, uV"},
        Bad{"0x10 V", Dimension::kVoltage, "\"0x10 V\" has the unit \"x10 V\"; allowed: V, mV, uV"},
        Bad{"1,5 V", Dimension::kVoltage, "\"1,5 V\" has the unit \",5 V\"; allowed: V, mV, uV"},
        Bad{"1e999 V", Dimension::kVoltage, "\"1e999 V\" is outside the range of numbers"},
        Bad{"1e308 MHz", Dimension::kFrequency, "\"1e308 MHz\" is outside the range of numbers"}));

TEST(Number, IsWholeAndDecimal) {
  EXPECT_EQ(parse_number("-1.5e3").value(), -1500.0);
  for (const char* text :
       {"", " 1", "1 ", "+1", "1x", "0x1p3", "nan", "inf", "-inf", "1e999", "1.2.3", "--1"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

}  // namespace
}  // namespace stickslip::base
