#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "cli/options.hpp"
#include <nlohmann/json.hpp>

#include "core/base/quantity.hpp"
#include "core/base/settings.hpp"
#include "daemon/types/quantity_json.hpp"

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
  const auto dimension = static_cast<Dimension>(*rc::gen::inRange(0, static_cast<int>(kLastDimension) + 1));
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

/// What an entry makes of a text: a value, or a refusal. Two refusals are alike if both end in the parser's
/// words.
void expect_same(const Result<double>& parsed, const Result<double>& entered, const std::string& where) {
  if (parsed) {
    if (!entered) RC_FAIL(where + " refuses: " + entered.error().message);
    RC_ASSERT(*parsed == *entered);
    return;
  }
  if (entered) RC_FAIL(where + " takes what the parser refuses: " + parsed.error().message);
  // The configuration shows the text in its own place.
  const std::string words = parsed.error().message.substr(parsed.error().message.find_last_of('"') + 1);
  if (!entered.error().message.ends_with(words)) RC_FAIL(where + ": " + entered.error().message);
}

// One rule in the whole product: configuration, command line and requests read any text with a number, a
// unit, or a wrong or no unit, to the same value, or refuse it alike.
RC_GTEST_PROP(QuantityProperty, EveryEntryReadsAlike, ()) {
  const auto dimension = static_cast<Dimension>(*rc::gen::inRange(1, static_cast<int>(kLastDimension) + 1));
  const std::string number =
      *rc::gen::element<std::string>("500", "0", "-3", "0.25", "1e-3", "12.5", "", "x", "1,5", "1e999");
  const std::string blank = *rc::gen::element<std::string>("", " ", "  ");
  const std::string unit =
      *rc::gen::element<std::string>("", std::string{si_unit(dimension)}, "g", "kg", "mm/s", "in/min", "s",
                                     "Hz", "kHz", "N/V", "mV", "stone");
  std::string text = number;
  text += blank;
  text += unit;
  const Result<double> parsed = parse_quantity(text, dimension);

  Result<Settings> settings = Settings::parse("key = \"" + text + "\"\n", "x.toml");
  RC_ASSERT(settings.has_value());
  Result<double> configured = settings->quantity("key", dimension, Limits::any());
  if (const Result<void> ok = settings->finish(); !ok) configured = tl::unexpected(ok.error());
  expect_same(parsed, configured, "configuration");

  const auto requested = daemon::quantity_of("key", nlohmann::ordered_json(text), dimension,
                                             BareNumber::kSiWithWarning, nullptr);
  expect_same(parsed, requested, "request");

  // An empty option was not given.
  if (text.empty()) return;
  const auto typed = cli::number_of("--option", text, dimension, false, BareNumber::kRefused);
  expect_same(parsed, typed ? Result<double>{typed->value()} : tl::unexpected(typed.error()), "command line");

  const auto entered = enter_quantity(text, dimension, BareNumber::kSiWithWarning);
  const bool bare = parse_number(number).has_value() && unit.empty();
  if (!bare && entered) RC_ASSERT(entered->warning.empty());
  if (bare && entered) {
    // Who follows the warning gets the same value.
    const std::string spelling = number + " " + std::string{si_unit(dimension)};
    RC_ASSERT(entered->warning.find(spelling) != std::string::npos);
    RC_ASSERT(parse_quantity(spelling, dimension).value() == entered->value);
  }
}

// Any bytes: a value or one reason, never a crash and never a number that is not finite.
RC_GTEST_PROP(QuantityProperty, AnyTextIsReadOrRefused, (const std::string& text)) {
  const Result<double> value = parse_quantity(text, Dimension::kMass);
  const bool answered = value ? std::isfinite(*value) : !value.error().message.empty();
  RC_ASSERT(answered);
}

}  // namespace
}  // namespace stickslip::base
