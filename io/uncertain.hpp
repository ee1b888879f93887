/// \file
/// A number with its errors as text for people. The only place in C++ that formats one; the pages have
/// report/uncertain.js, which gives the same.
///
///     uncertain(results.delta_mu, 4).text();   // "0.0470 ± 0.0027 ± 0.0019": statistical, then systematic
///     uncertain(results.mu_s, 4).text();       // "0.3512 ± 0.0003": the systematic part is absent
///     uncertain(results.mu_k, 4).text();       // "0.30? ± 0.41 ± 0.12": not significant
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/analysis/results.hpp"

namespace stickslip::io {

/// Legends of what uncertain() gives; each is one line for a terminal of 80 columns, without line feed.
inline constexpr std::string_view kErrorsLegend =
    "± standard error ± systematic part (calibration, corrections)";
inline constexpr std::string_view kStandardErrorLegend = "± standard error";
inline constexpr std::string_view kNotSignificantLegend = "?  not significant, its errors together exceed it";

/// Parts of a number with its errors.
struct Uncertain {
  std::string value;           ///< With "?" behind it if not significant; kAbsent without a value.
  std::string standard_error;  ///< Empty if unknown.
  std::string systematic;      ///< Empty if unknown.
  bool significant = true;     ///< False if the errors, in quadrature, exceed the absolute value.

  /// On one line. A systematic part alone is marked "(syst.)", since one error alone is the standard error.
  [[nodiscard]] std::string text() const;
};

/// The decimals show two significant digits of the larger error. A smaller one that would round to zero has
/// one significant digit ("0.0494 ± 0.00003 ± 0.0028"), or is given as a bound ("<0.000001") beyond the most
/// decimals. An infinite error is "∞"; NaN is an unknown error.
/// \param decimals  of a value without errors; with errors at most two more. nullopt: of any scale: six
/// significant digits without errors, up to twelve decimals with errors.
[[nodiscard]] Uncertain uncertain(const analysis::Estimate& estimate, std::optional<int> decimals);

/// Decimals of a number whose uncertainty stands beside it: two significant digits of that, at most two more
/// than `plain`, which are those of a number without one.
[[nodiscard]] int decimals_for(const std::optional<double>& uncertainty, int plain);

/// The estimate times a factor, as for another unit.
[[nodiscard]] analysis::Estimate scaled(analysis::Estimate estimate, double factor);

}  // namespace stickslip::io
