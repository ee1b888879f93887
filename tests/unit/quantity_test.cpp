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
        Good{"23.1 degC", Dimension::kTemperature, 23.1}, Good{"-40 °C", Dimension::kTemperature, -40},
        Good{"-40 °F", Dimension::kTemperature, -40}, Good{"273.15 K", Dimension::kTemperature, 0},
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
        Bad{"12", Dimension::kMass, "\"12\": a mass needs its unit, such as \"12 g\" or \"12 kg\""},
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
        Bad{"1,5 V", Dimension::kVoltage,
            "\"1,5 V\" has a comma: the decimal sign is a point: write \"1.5 V\""},
        Bad{"1e999 V", Dimension::kVoltage, "\"1e999 V\" is outside the range of numbers"},
        Bad{"1e308 MHz", Dimension::kFrequency, "\"1e308 MHz\" is outside the range of numbers"}));

TEST(EnteredQuantity, TakesANumberAloneByTheRuleOfThePlace) {
  for (const BareNumber rule : {BareNumber::kRefused, BareNumber::kOnlyZero}) {
    const auto entered = enter_quantity(" 500 ", Dimension::kMass, rule);
    ASSERT_FALSE(entered);
    EXPECT_EQ(entered.error().message, "\" 500 \": a mass needs its unit, such as \"500 g\" or \"500 kg\"");
  }
  EXPECT_FALSE(enter_quantity("0", Dimension::kMass, BareNumber::kRefused));
  EXPECT_EQ(enter_quantity("0", Dimension::kMass, BareNumber::kOnlyZero).value().value, 0.0);
  EXPECT_FALSE(enter_quantity("0", Dimension::kTemperature, BareNumber::kOnlyZero)) << "0 K or 0 degC?";
  const auto silent = enter_quantity("1.5", Dimension::kTime, BareNumber::kSi).value();
  EXPECT_EQ(silent.value, 1.5);
  EXPECT_EQ(silent.warning, "");
  const auto warned = enter_quantity("350", Dimension::kFrequency, BareNumber::kSiWithWarning).value();
  EXPECT_EQ(warned.value, 350.0);
  EXPECT_EQ(warned.warning,
            "\"350\": a frequency needs its unit; it is read as \"350 Hz\": write that, as the next version "
            "refuses a number alone");
}

TEST(EnteredQuantity, NeedsNoUnitWhereThereIsNone) {
  for (const BareNumber rule :
       {BareNumber::kRefused, BareNumber::kOnlyZero, BareNumber::kSiWithWarning, BareNumber::kSi}) {
    const auto entered = enter_quantity("0.3", Dimension::kDimensionless, rule).value();
    EXPECT_EQ(entered.value, 0.3);
    EXPECT_EQ(entered.warning, "");
  }
}

// Whoever follows the message is understood.
TEST(UnitNeeded, NamesTwoSpellingsThatAreAccepted) {
  for (int i = 1; i <= static_cast<int>(kLastDimension); ++i) {
    const auto dimension = static_cast<Dimension>(i);
    EXPECT_EQ(dimension_of_unit(si_unit(dimension)), dimension);
    const std::string message = unit_needed("500", dimension);
    const std::size_t first = message.find('"');
    const std::size_t between = message.find("\" or \"");
    ASSERT_NE(between, std::string::npos) << message;
    const std::string one = message.substr(first + 1, between - first - 1);
    const std::string other = message.substr(between + 6, message.size() - between - 7);
    EXPECT_TRUE(parse_quantity(one, dimension)) << message;
    EXPECT_TRUE(parse_quantity(other, dimension)) << message;
    EXPECT_NE(one, other);
  }
  EXPECT_EQ(dimension_of_unit("1"), Dimension::kDimensionless);
}

TEST(Number, IsWholeAndDecimal) {
  EXPECT_EQ(parse_number("-1.5e3").value(), -1500.0);
  for (const char* text :
       {"", " 1", "1 ", "+1", "1x", "0x1p3", "nan", "inf", "-inf", "1e999", "1.2.3", "--1"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

}  // namespace
}  // namespace stickslip::base
