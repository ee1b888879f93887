#include "core/record/tester_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/settings.hpp"

namespace stickslip::record {
namespace {

using base::Dimension;
using base::Limits;

base::Result<estimate::SharedPrior::Coupling> coupling_of(base::Settings settings) {
  base::Settings table = settings.table("tester");
  // For people, and checked as all keys are.
  (void)table.text("characterised", std::string{});
  (void)table.integer("ring_downs", 1, std::numeric_limits<std::int32_t>::max(), 1);
  (void)table.quantity("chi_squared", Dimension::kDimensionless, Limits::at_least(0.0), 0.0);
  estimate::SharedPrior::Coupling coupling;
  coupling.omega = table.quantity("omega", Dimension::kAngularFrequency, Limits::above(0.0));
  const double omega_error =
      table.quantity("omega_standard_error", Dimension::kAngularFrequency, Limits::above(0.0));
  coupling.gamma_over_2omega =
      table.quantity("gamma_over_2omega", Dimension::kDimensionless, Limits::between(0.0, 1.0));
  const double gamma_error =
      table.quantity("gamma_over_2omega_standard_error", Dimension::kDimensionless, Limits::above(0.0));
  // A correlation of ±1 would leave no covariance to invert.
  const double correlation =
      table.quantity("correlation", Dimension::kDimensionless, Limits::between(-0.999, 0.999), 0.0);
  if (const base::Result<void> ok = settings.finish(); !ok) return tl::unexpected(ok.error());
  const double mixed = correlation * omega_error * gamma_error;
  coupling.covariance << omega_error * omega_error, mixed, mixed, gamma_error * gamma_error;
  return coupling;
}

}  // namespace

std::string tester_text(const analysis::Characterisation& characterisation, std::string_view date) {
  const estimate::SharedPrior::Coupling& coupling = characterisation.coupling;
  const double omega_error = std::sqrt(coupling.covariance(0, 0));
  const double gamma_error = std::sqrt(coupling.covariance(1, 1));
  return fmt::format(
      "# Characterisation of a tester by `stickslip characterise`. It holds until sled, coupling or load "
      "cell\n"
      "# are changed.\n\n"
      "[tester]\n"
      "characterised = \"{}\"  # begin of the latest ring-down; empty if its record has no date\n"
      "ring_downs = {}\n"
      "chi_squared = {:.4g}  # of their disagreement, for {} degrees of freedom\n"
      "omega = \"{:.10g} rad/s\"  # above 0: damped\n"
      "omega_standard_error = \"{:.6g} rad/s\"  # above 0\n"
      "gamma_over_2omega = {:.10g}  # 0 to 1\n"
      "gamma_over_2omega_standard_error = {:.6g}  # above 0\n"
      "correlation = {:.6g}  # of the two, -0.999 to 0.999; default 0\n",
      date, characterisation.ring_downs, characterisation.chi_squared, characterisation.freedom,
      coupling.omega, omega_error, coupling.gamma_over_2omega, gamma_error,
      coupling.covariance(0, 1) / omega_error / gamma_error);
}

base::Result<estimate::SharedPrior::Coupling> parse_tester(std::string_view text, std::string_view name) {
  base::Result<base::Settings> settings = base::Settings::parse(text, name);
  if (!settings) return tl::unexpected(settings.error());
  return coupling_of(*settings);
}

base::Result<estimate::SharedPrior::Coupling> load_tester(const std::filesystem::path& file) {
  base::Result<base::Settings> settings = base::Settings::load(file);
  if (!settings) return tl::unexpected(settings.error());
  return coupling_of(*settings);
}

}  // namespace stickslip::record
