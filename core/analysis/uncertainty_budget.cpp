#include "core/analysis/uncertainty_budget.hpp"

#include <utility>

#include "core/detect/slip_rule.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

using enum BudgetState;

BudgetLine counted(std::string_view source, std::string_view title, char type, double size) {
  return {source, title, type, kCounted, size, size * size, {}};
}

bool is_of(const Quantity& quantity, Estimate TestResults::*estimate) {
  return quantity.estimate == estimate;
}

BudgetLine noise_line(const TestResults& results, const Quantity& quantity) {
  BudgetLine line{"noise", "noise", 'A', kUnknown, {}, 0.0, {}};
  std::optional<double> error = (results.*quantity.estimate).standard_error;
  if (error && std::isnan(*error)) error.reset();
  // The peak is one scan.
  if (!error && is_of(quantity, &TestResults::static_coefficient) && results.smallest_slip.value)
    error = *results.smallest_slip.value / detect::SlipRule::kSignificantSigmas;
  if (error) return counted(line.source, line.title, line.type, *error);
  line.note = is_of(quantity, &TestResults::delta_mu)
                  ? "a single slip tells no error: pull further, or test more sheets"
                  : "one test tells no error of this mean: test more sheets";
  return line;
}

BudgetLine resolution_line(const BudgetFacts& facts) {
  BudgetLine line{
      "resolution", "resolution", 'B', kIncluded, {}, 0.0, "in the noise: each scan was rounded before it"};
  if (facts.step_coefficient && *facts.step_coefficient > 0.0)
    line.size = signal::kRoundingSigma * *facts.step_coefficient;
  return line;
}

BudgetLine speed_line(const TestResults& results, const Quantity& quantity, const BudgetFacts& facts) {
  BudgetLine line{"speed", "pull speed", 'B', kNone, {}, 0.0, {}};
  if (is_of(quantity, &TestResults::delta_mu)) {
    if (results.rung == Rung::kTurningPoints) {
      line.state = kIncluded;
      line.note = "in the correction";
    } else {
      line.note = "not used: the fit finds it";
    }
    return line;
  }
  if (is_of(quantity, &TestResults::static_coefficient)) {
    line.note = "not used: the peak as read";
    return line;
  }
  if (!facts.method) {
    line.state = kUnknown;
    line.note = "the record names no method: name it, with --method";
    return line;
  }
  if (!facts.method->kinetic_travel) {
    line.note = "not used: the mean of whole cycles";
    return line;
  }
  const std::optional<double>& measured = results.pull_speed_measured.value;
  const std::optional<double>& drift = results.drift_rate.value;
  if (!facts.pull_speed_m_per_s || !measured || !drift) {
    line.state = kUnknown;
    line.note =
        "the method's travel counts by the planned speed, and none was measured: characterise the tester";
    return line;
  }
  // The window [from, to]/v moves by its middle times the relative error of v; the mean drifts in that time.
  const model::TravelWindow& travel = *facts.method->kinetic_travel;
  const double middle_s = 0.5 * (travel.from_m + travel.to_m) / *facts.pull_speed_m_per_s;
  return counted(line.source, line.title, line.type,
                 std::abs(*drift * middle_s * (*measured / *facts.pull_speed_m_per_s - 1.0)));
}

BudgetLine systematic_line(UncertaintySource source, std::optional<double> size, double variance) {
  const UncertaintySourceName& own = name_of(source);
  return {own.name, own.title, 'B', kCounted, size, variance, {}};
}

/// A source that is part of the whole that an older record has, or not known.
void tell_absent(BudgetLine& line, bool is_unnamed, std::string note) {
  line.size.reset();
  line.state = is_unnamed ? kIncluded : kUnknown;
  line.note = is_unnamed ? "in the systematic part, which this record does not split" : std::move(note);
}

void add_systematic_lines(const Estimate& estimate, const Quantity& quantity, UncertaintyBudget& budget) {
  const bool is_delta_mu = is_of(quantity, &TestResults::delta_mu);
  const Contributions contributions = contributions_of(estimate);
  double total = estimate.systematic_uncertainty.value_or(0.0);
  if (std::isnan(total)) total = 0.0;  // As contributions_of() takes it.
  const bool is_unnamed = contributions.unnamed > 0.0;
  bool has_model = false;
  for_each_part(estimate.systematic_parts, [&](UncertaintySource source, const std::optional<double>& size) {
    BudgetLine line =
        systematic_line(source, size, total * contributions.of[static_cast<std::size_t>(source)]);
    const bool is_told = size && !is_unnamed;
    if (source == UncertaintySource::kCalibration) {
      if (!is_told)
        tell_absent(line, is_unnamed, "no uncertainty of the gain: hang weights, stickslip calibrate");
    } else if (source == UncertaintySource::kZero) {
      if (is_delta_mu && !size) {
        line.state = kNone;
        line.note = "cancels in S − K";
      } else if (!is_told) {
        tell_absent(line, is_unnamed, "the unloaded cell was not read; the daemon reads it before each test");
      } else if (*size == 0.0) {
        line.state = kNone;
        line.note = "the unloaded cell read less than the limit of the finding zero-offset";
      }
    } else if (is_told) {
      has_model = true;
    } else {
      return;
    }
    budget.lines.push_back(std::move(line));
  });
  if (is_unnamed) {
    budget.lines.push_back({"unnamed", "systematic, not split", 'B', kCounted, contributions.unnamed,
                            contributions.unnamed * total,
                            "of an older version: stickslip analyze --json tells the parts"});
  } else if (!has_model) {
    BudgetLine line{"model", "model", 'B', kNone, {}, 0.0, "not used: read off the trace"};
    if (is_delta_mu) {
      line.state = kUnknown;
      line.note = "not in the record: stickslip analyze --json tells it";
    }
    budget.lines.push_back(std::move(line));
  }
}

}  // namespace

std::string_view name(BudgetState state) noexcept {
  switch (state) {
    case kCounted:
      return "counted";
    case kIncluded:
      return "included";
    case kNone:
      return "none";
    case kUnknown:
      return "unknown";
  }
  return "";
}

std::string UncertaintyBudget::unknown() const {
  std::string titles;
  for (const BudgetLine& line : lines) {
    if (line.state != kUnknown) continue;
    if (!titles.empty()) titles += ", ";
    titles += line.title;
  }
  return titles;
}

void combine(UncertaintyBudget& budget) {
  double variance = 0.0;
  bool is_known = false;
  for (const BudgetLine& line : budget.lines) {
    if (line.state != kCounted) continue;
    is_known = true;
    variance += line.variance;
  }
  budget.combined = is_known ? std::optional{std::sqrt(variance)} : std::nullopt;
}

std::optional<UncertaintyBudget> test_budget(const TestResults& results, const Quantity& quantity,
                                             const BudgetFacts& facts) {
  const Estimate& estimate = results.*quantity.estimate;
  if (!estimate.value) return std::nullopt;
  UncertaintyBudget budget;
  budget.value = *estimate.value;
  budget.lines = {
      noise_line(results, quantity),
      {"replicates", "replicates", 'A', kUnknown, {}, 0.0, "one test: test more sheets"},
      resolution_line(facts),
  };
  add_systematic_lines(estimate, quantity, budget);
  budget.lines.push_back(speed_line(results, quantity, facts));
  combine(budget);
  return budget;
}

}  // namespace stickslip::analysis
