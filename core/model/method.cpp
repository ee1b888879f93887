#include "core/model/method.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "core/base/digits.hpp"

namespace stickslip::model {
namespace {

/// A nominal value at the edge of its tolerance is allowed whatever unit it was typed in: conversion rounds
/// by parts in 1e16.
constexpr double kRounding = 1e-12;

void compare(std::string_view what, std::string_view unit, const std::string& method,
             const std::optional<Nominal>& asked, const std::optional<double>& found,
             std::vector<std::string>& lines) {
  if (!asked || !asked->tolerance || !found) return;
  if (std::abs(*found - asked->value) <= *asked->tolerance + kRounding * std::abs(asked->value)) return;
  lines.push_back(fmt::format("{} {:.6g} {}, {} asks {:.6g} ± {:.6g} {}", what, *found, unit, method,
                              asked->value, *asked->tolerance, unit));
}

}  // namespace

std::vector<std::string> departures(const Method& method, std::optional<double> sled_mass_kg,
                                    std::optional<double> pull_speed_m_per_s) {
  std::vector<std::string> lines;
  compare("sled mass", "kg", method.name, method.sled_mass_kg, sled_mass_kg, lines);
  if (const std::optional<Nominal>& asked = method.pull_speed_m_per_s) {
    // In the method's unit.
    const base::SpeedUnit unit = base::unit_of_speed(asked->value);
    const auto in_unit = [&unit](const std::optional<double>& speed_m_per_s) {
      return speed_m_per_s ? std::optional{*speed_m_per_s / unit.m_per_s} : std::nullopt;
    };
    compare("pull speed", unit.symbol, method.name,
            Nominal{asked->value / unit.m_per_s, in_unit(asked->tolerance)}, in_unit(pull_speed_m_per_s),
            lines);
  }
  return lines;
}

}  // namespace stickslip::model
