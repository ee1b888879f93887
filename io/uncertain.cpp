#include "io/uncertain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/table.hpp"

#include "core/base/digits.hpp"

namespace stickslip::io {
namespace {

constexpr int kMoreDecimals = 2;
constexpr int kMostDecimals = 12;

std::optional<double> known(const std::optional<double>& error) {
  if (!error || std::isnan(*error)) return std::nullopt;
  return std::abs(*error);
}

double finite_or_zero(const std::optional<double>& error) {
  return error && std::isfinite(*error) ? *error : 0.0;
}

std::string error_text(double error, int decimals, int most) {
  if (std::isinf(error)) return "∞";
  std::string text = fmt::format("{:.{}f}", error, decimals);
  if (!(error > 0.0) || text.find_first_of("123456789") != std::string::npos) return text;
  const int own = base::decimals_of(error, 1);
  return own <= most ? fmt::format("{:.{}f}", error, own)
                     : fmt::format("<{:.{}f}", std::pow(10.0, -most), most);
}

}  // namespace

std::string Uncertain::text() const {
  std::string text = value;
  if (!standard_error.empty()) text += " ± " + standard_error;
  if (!systematic.empty()) text += " ± " + systematic + (standard_error.empty() ? " (syst.)" : "");
  return text;
}

int decimals_for(const std::optional<double>& uncertainty, int plain) {
  const double size = std::abs(finite_or_zero(uncertainty));
  if (!(size > 0.0)) return plain;
  return std::clamp(base::decimals_of(size, base::kUncertaintyDigits), 0, plain + kMoreDecimals);
}

Uncertain uncertain(const analysis::Estimate& estimate, std::optional<int> decimals) {
  if (!estimate.value || !std::isfinite(*estimate.value)) return {std::string{kAbsent}, "", "", true};
  const std::optional<double> random = known(estimate.standard_error);
  const std::optional<double> systematic = known(estimate.systematic_uncertainty);
  const double largest = std::max(finite_or_zero(random), finite_or_zero(systematic));
  const int most = decimals ? *decimals + kMoreDecimals : kMostDecimals;
  const int shown = largest > 0.0 ? std::clamp(base::decimals_of(largest, base::kUncertaintyDigits), 0, most)
                                  : decimals.value_or(0);
  Uncertain result;
  result.significant =
      !(std::hypot(random.value_or(0.0), systematic.value_or(0.0)) > std::abs(*estimate.value));
  result.value = largest > 0.0 || decimals ? fmt::format("{:.{}f}", *estimate.value, shown)
                                           : fmt::format("{:.6g}", *estimate.value);
  if (!result.significant) result.value += '?';
  if (random) result.standard_error = error_text(*random, shown, most);
  if (systematic) result.systematic = error_text(*systematic, shown, most);
  return result;
}

analysis::Estimate scaled(analysis::Estimate estimate, double factor) {
  for (std::optional<double>* number :
       {&estimate.value, &estimate.standard_error, &estimate.systematic_uncertainty}) {
    if (*number) **number *= factor;
  }
  for_each_part(estimate.systematic_parts, [&](analysis::UncertaintySource, std::optional<double>& size) {
    if (size) *size *= factor;
  });
  return estimate;
}

}  // namespace stickslip::io
