#include "core/analysis/uncertainty_part.hpp"

#include <cmath>

#include "core/analysis/results.hpp"

namespace stickslip::analysis {
namespace {

/// What the parts of a record may miss of its total by rounding.
constexpr double kOfRounding = 1e-6;

/// Those that add as they are.
double sum_of(const SystematicParts& parts) noexcept {
  double sum = 0.0;
  for_each_part(parts, [&](UncertaintySource source, const std::optional<double>& size) {
    if (!name_of(source).is_independent) sum += size.value_or(0.0);
  });
  return sum;
}

}  // namespace

const UncertaintySourceName& name_of(UncertaintySource source) noexcept {
  static constexpr std::array<UncertaintySourceName, kUncertaintySourceCount> kNames{{
      {"calibration", "calibration", true},
      {"zero", "zero", true},
      {"clock", "clock", true},
      {"damping", "model: damping", false},
      {"creep", "model: creep at onset", false},
      {"misfit", "model: misfit", false},
      {"rung", "model: other rung", false},
      {"correction", "model: correction", false},
      {"bound", "model: only a bound", false},
  }};
  return kNames[static_cast<std::size_t>(source)];
}

void add_systematic(Estimate& estimate, std::initializer_list<UncertaintyPart> parts) {
  if (!estimate.value) return;
  double sum = 0.0;
  std::optional<double>& total = estimate.systematic_uncertainty;
  for (const auto& [source, size] : parts) {
    std::optional<double>& part = estimate.systematic_parts[source];
    if (name_of(source).is_independent) {
      part = std::hypot(part.value_or(0.0), size);
      total = std::hypot(total.value_or(0.0), size);
    } else {
      part = part.value_or(0.0) + std::abs(size);
      sum += std::abs(size);
      total = total.value_or(0.0);
    }
  }
  if (total) *total += sum;
}

void add_systematic(Estimate& estimate, UncertaintySource source, double size) {
  add_systematic(estimate, {{source, size}});
}

void note_no_systematic(Estimate& estimate, UncertaintySource source) {
  std::optional<double>& part = estimate.systematic_parts[source];
  if (estimate.value && !part) part = 0.0;
}

double total_of(const SystematicParts& parts) noexcept {
  double total = sum_of(parts);
  for_each_part(parts, [&](UncertaintySource source, const std::optional<double>& size) {
    if (name_of(source).is_independent) total = std::hypot(total, size.value_or(0.0));
  });
  return total;
}

Contributions contributions_of(const Estimate& estimate) noexcept {
  Contributions contributions;
  const double total = estimate.systematic_uncertainty.value_or(0.0);
  if (!(total > 0.0)) return contributions;  // Unknown: a file may hold NaN.
  if (!std::isfinite(total) ||
      !(std::abs(total_of(estimate.systematic_parts) - total) <= kOfRounding * total)) {
    contributions.unnamed = total;
    return contributions;
  }
  const double sum = sum_of(estimate.systematic_parts);
  for_each_part(estimate.systematic_parts, [&](UncertaintySource source, const std::optional<double>& size) {
    const double own = size.value_or(0.0);
    contributions.of[static_cast<std::size_t>(source)] =
        own * (name_of(source).is_independent ? own : sum) / total;
  });
  return contributions;
}

}  // namespace stickslip::analysis
