#include "core/pipeline/zero_offset.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/pipeline/unloaded_level.hpp"

namespace stickslip::pipeline {

void add_zero_offset(friction::TestResults& results, std::optional<double> unloaded_level) {
  const double offset = UnloadedLevel::of_decisions(unloaded_level.value_or(0.0));
  if (offset == 0.0) return;
  results.findings.push_back(fmt::format(
      "zero: the unloaded cell read {:+.4f} before the test, more than {:g}; static, kinetic, S and K "
      "are off by it, S - K is not; tare before the next test",
      offset, UnloadedLevel::kNearest));
  for (friction::Estimate* estimate :
       {&results.static_coefficient, &results.kinetic_coefficient, &results.mu_s, &results.mu_k,
        &results.mu_k_from_mean, &results.mu_s_from_amplitude}) {
    if (!estimate->value) continue;
    estimate->systematic_uncertainty = std::hypot(estimate->systematic_uncertainty.value_or(0.0), offset);
  }
}

}  // namespace stickslip::pipeline
