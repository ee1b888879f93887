#include "core/pipeline/zero_offset.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/pipeline/unloaded_level.hpp"

namespace stickslip::pipeline {

void add_zero_offset(analysis::TestResults& results, std::optional<double> before,
                     std::optional<double> after) {
  // A file may hold anything.
  const auto off = [](std::optional<double> level) {
    return level && std::isfinite(*level) ? UnloadedLevel::of_decisions(*level) : 0.0;
  };
  const bool worse_after = std::abs(off(after)) > std::abs(off(before));
  const double offset = worse_after ? off(after) : off(before);
  if (offset == 0.0) return;
  base::add(
      results.findings,
      base::make_finding(
          base::FindingCode::kZeroOffset,
          fmt::format("zero: the unloaded cell read {:+.4f} {} the test, more than {:g}; static, kinetic, "
                      "S and K are off by it, S - K is not; tare before the next test",
                      offset, worse_after ? "after" : "before", UnloadedLevel::kNearest),
          {{"offset", offset, "1"}, {"limit", UnloadedLevel::kNearest, "1"}}));
  for (analysis::Estimate* estimate :
       {&results.static_coefficient, &results.kinetic_coefficient, &results.mu_s, &results.mu_k,
        &results.mu_k_from_mean, &results.mu_s_from_amplitude}) {
    if (!estimate->value) continue;
    estimate->systematic_uncertainty = std::hypot(estimate->systematic_uncertainty.value_or(0.0), offset);
  }
}

}  // namespace stickslip::pipeline
