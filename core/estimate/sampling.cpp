#include "core/estimate/sampling.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace stickslip::estimate {

std::optional<double> expected_frequency_Hz(const model::Tester& tester, const SharedPrior& prior) {
  if (prior.coupling) return prior.coupling->omega / (2.0 * std::numbers::pi);
  if (!tester.stiffness_N_per_m || !(tester.sled_mass_kg > 0.0)) return std::nullopt;
  return std::sqrt(*tester.stiffness_N_per_m / tester.sled_mass_kg) / (2.0 * std::numbers::pi);
}

SamplingVerdict check_sampling(double scan_rate_Hz, std::optional<double> frequency_Hz) {
  if (!frequency_Hz) {
    return {SamplingVerdict::Kind::kNotVerifiable,
            "frequency not verifiable: neither a characterised tester nor a stiffness is known"};
  }
  const double scans = scan_rate_Hz / *frequency_Hz;
  const auto reason = [&](double needed, const char* what) {
    return fmt::format(
        "{:.4g} scans/s are {:.2g} a cycle of the expected {:.3g} Hz: {}; {:.0f} scans/s or more",
        scan_rate_Hz, scans, *frequency_Hz, what, std::ceil(needed * *frequency_Hz));
  };
  if (scans < kFewestScansACycle)
    return {SamplingVerdict::Kind::kRefused, reason(kFewestScansACycle, "slips cannot be seen")};
  if (scans < kFewScansACycle)
    return {SamplingVerdict::Kind::kFew, reason(kFewScansACycle, "peaks are missed")};
  return {SamplingVerdict::Kind::kFine, {}};
}

}  // namespace stickslip::estimate
