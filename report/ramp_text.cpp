#include "report/ramp_text.hpp"

#include <fmt/format.h>

#include "report/millimetres.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

std::string with_error(const analysis::Estimate& estimate, double scale, int decimals) {
  std::string value = fmt::format("{:.{}f}", scale * *estimate.value, decimals);
  if (!estimate.standard_error) return value;
  return fmt::format("{} ± {:.{}f}", value, scale * *estimate.standard_error, decimals);
}

}  // namespace

std::string ramp_text(const analysis::TestResults& results) {
  if (results.Q.reason != analysis::kSpeedChanges || !results.delta_mu.value) return {};
  std::string text = "S−K " + with_error(results.delta_mu, 1.0, 4);
  if (results.delta_mu_scatter.value)
    text += fmt::format(", scatter {:.4f}", *results.delta_mu_scatter.value);
  text += ", slip by slip; ";
  const analysis::Estimate& escape = results.escape_speed;
  if (!escape.value) return text + "no escape speed: " + base::printable(escape.reason);
  text += fmt::format("escaped at {} mm/s, the first of many: ", with_error(escape, kMillimetresPerMetre, 2));
  const analysis::Estimate& corrected = results.escape_speed_corrected;
  if (!corrected.value) return text + "not corrected, " + base::printable(corrected.reason);
  return text + with_error(corrected, kMillimetresPerMetre, 2) + " mm/s for the mean of S−K";
}

}  // namespace stickslip::report
