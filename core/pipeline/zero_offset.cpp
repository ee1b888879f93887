#include "core/pipeline/zero_offset.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/pipeline/unloaded_level.hpp"

namespace stickslip::pipeline {

using analysis::UncertaintySource;

void add_zero_offset(analysis::TestResults& results, std::optional<double> before,
                     std::optional<double> after) {
  // A file may hold anything.
  const auto is_known = [](std::optional<double> level) { return level && std::isfinite(*level); };
  const auto off = [&](std::optional<double> level) {
    return is_known(level) ? UnloadedLevel::of_decisions(*level) : 0.0;
  };
  const bool worse_after = std::abs(off(after)) > std::abs(off(before));
  const double offset = worse_after ? off(after) : off(before);
  const std::array shifted{
      &results.static_coefficient, &results.kinetic_coefficient, &results.mu_s, &results.mu_k,
      &results.mu_k_from_mean,     &results.mu_s_from_amplitude};
  if (offset == 0.0) {
    if (is_known(before) || is_known(after)) {
      for (analysis::Estimate* estimate : shifted) note_no_systematic(*estimate, UncertaintySource::kZero);
    }
    return;
  }
  base::add(
      results.findings,
      base::make_finding(
          base::FindingCode::kZeroOffset,
          fmt::format("zero: the unloaded cell read {:+.4f} {} the test, more than {:g}; static, kinetic, "
                      "S and K are off by it, S - K is not; tare before the next test",
                      offset, worse_after ? "after" : "before", UnloadedLevel::kNearest),
          {{"offset", offset, "1"}, {"limit", UnloadedLevel::kNearest, "1"}}));
  for (analysis::Estimate* estimate : shifted) add_systematic(*estimate, UncertaintySource::kZero, offset);
}

}  // namespace stickslip::pipeline
