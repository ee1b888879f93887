#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "core/base/quantity.hpp"

namespace stickslip::base {
namespace {

double finite_number() {
  return *rc::gen::suchThat(rc::gen::map(rc::gen::arbitrary<std::int64_t>(),
                                         [](std::int64_t bits) {
                                           double value = 0.0;
                                           static_assert(sizeof value == sizeof bits);
                                           std::memcpy(&value, &bits, sizeof value);
                                           return value;
                                         }),
                            [](double value) { return std::isfinite(value); });
}

// Written in the SI unit and read back: the same double, whatever its bits.
RC_GTEST_PROP(QuantityProperty, SurvivesWritingAndReading, ()) {
  const double value = finite_number();
  const auto dimension =
      static_cast<Dimension>(*rc::gen::inRange(0, static_cast<int>(Dimension::kAngle) + 1));
  const Result<double> back = parse_quantity(format_quantity(value, dimension), dimension);
  RC_ASSERT(back.has_value());
  RC_ASSERT(*back == value);
}

// x → 60 x in a minute-based unit is x in a second-based one. Three roundings at most on each
// side (number, factor, quotient), each of half an ulp: 2^-53 · 6 < 1e-15 relative.
RC_GTEST_PROP(QuantityProperty, UnitsOfOneDimensionAgree, (int thousandths)) {
  const double per_second = parse_quantity(fmt::format("{}e-3 in/s", thousandths), Dimension::kSpeed).value();
  const double per_minute =
      parse_quantity(fmt::format("{}e-3 in/min", 60LL * thousandths), Dimension::kSpeed).value();
  RC_ASSERT(std::abs(per_second - per_minute) <= 1e-15 * std::abs(per_second));
}

// Any bytes: a value or one reason, never a crash and never a number that is not finite.
RC_GTEST_PROP(QuantityProperty, AnyTextIsReadOrRefused, (const std::string& text)) {
  const Result<double> value = parse_quantity(text, Dimension::kMass);
  const bool answered = value ? std::isfinite(*value) : !value.error().message.empty();
  RC_ASSERT(answered);
}

}  // namespace
}  // namespace stickslip::base
