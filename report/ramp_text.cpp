#include "report/ramp_text.hpp"

#include <fmt/format.h>

#include "io/uncertain.hpp"
#include "report/millimetres.hpp"

#include "core/base/text.hpp"

namespace stickslip::report {
namespace {

std::string mm_per_s(const analysis::Estimate& speed) {
  return io::uncertain(io::scaled(speed, kMillimetresPerMetre), 2).text() + " mm/s";
}

}  // namespace

std::string ramp_text(const analysis::TestResults& results) {
  if (results.Q.reason != analysis::kSpeedChanges || !results.delta_mu.value) return {};
  std::string text = "S−K " + io::uncertain(results.delta_mu, 4).text();
  if (results.delta_mu_scatter.value)
    text += fmt::format(", scatter {:.4f}", *results.delta_mu_scatter.value);
  text += ", slip by slip; ";
  const analysis::Estimate& escape = results.escape_speed;
  if (!escape.value) return text + "no escape speed: " + base::printable(escape.reason);
  text += fmt::format("escaped at {}, the first of many: ", mm_per_s(escape));
  const analysis::Estimate& corrected = results.escape_speed_corrected;
  if (!corrected.value) return text + "not corrected, " + base::printable(corrected.reason);
  return text + mm_per_s(corrected) + " for the mean of S−K";
}

}  // namespace stickslip::report
