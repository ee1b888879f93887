#include "core/detect/regime_rule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stickslip::detect {

RegimeVerdict judge_regime(std::size_t slip_count, const base::LongColumn<double>& log_likelihood_ratios,
                           bool model_describes) {
  if (slip_count == 0) return {model::Regime::kSteadySliding, "no fall of the force is a slip", {}};
  if (log_likelihood_ratios.empty()) {
    return {model::Regime::kUndecided, "one slip: nothing after it tells how it ended", {}};
  }
  // Log-likelihoods of the classes over "all free". Mixed takes the best for each slip, but must
  // hold at least one of each kind, so it gives up the weakest where all agree.
  double all_captured = 0.0;
  double best_of_each = 0.0;
  double weakest = std::numeric_limits<double>::infinity();
  std::ptrdiff_t captured = 0;
  std::ptrdiff_t count = 0;
  for (const double ratio : log_likelihood_ratios) {
    if (ratio == 0.0) continue;  // Says nothing.
    ++count;
    if (ratio > 0.0) ++captured;
    all_captured += ratio;
    best_of_each += std::max(ratio, 0.0);
    weakest = std::min(weakest, std::abs(ratio));
  }
  if (count == 0) return {model::Regime::kUndecided, "no slip tells how it ended", {}};
  const bool unanimous = captured == 0 || captured == count;
  if (!unanimous && !model_describes) {
    return {
        model::Regime::kUndecided,
        fmt::format("{} of {} slips look captured, but the model does not describe them", captured, count),
        {}};
  }
  const double mixed = unanimous ? best_of_each - weakest : best_of_each;

  struct Class {
    model::Regime regime;
    double log_likelihood;
  };
  std::array<Class, 3> classes{{{model::Regime::kStickSlip, all_captured},
                                {model::Regime::kRingDown, 0.0},
                                {model::Regime::kMixed, mixed}}};
  std::sort(classes.begin(), classes.end(),
            [](const Class& a, const Class& b) { return a.log_likelihood > b.log_likelihood; });
  const double lead = classes[0].log_likelihood - classes[1].log_likelihood;
  if (lead < std::log(kDecisiveLikelihoodRatio)) {
    return {model::Regime::kUndecided,
            fmt::format("{} is only {:.1f} times as likely as {}, {:.0f} are wanted",
                        model::name(classes[0].regime), std::exp(lead), model::name(classes[1].regime),
                        kDecisiveLikelihoodRatio),
            {}};
  }
  RegimeVerdict verdict;
  verdict.regime = classes[0].regime;
  verdict.reason = fmt::format("{} of {} slips ended in sticking", captured, count);
  if (verdict.regime == model::Regime::kMixed) {
    const auto tells = [](double ratio) { return ratio != 0.0; };
    const auto first = std::find_if(log_likelihood_ratios.begin(), log_likelihood_ratios.end(), tells);
    const auto changed = std::find_if(first, log_likelihood_ratios.end(), [&](double ratio) {
      return tells(ratio) && (ratio > 0.0) != (*first > 0.0);
    });
    verdict.transition_slip = static_cast<std::size_t>(changed - log_likelihood_ratios.begin());
  }
  return verdict;
}

}  // namespace stickslip::detect
