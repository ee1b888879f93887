#include "core/analysis/test_fit.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/analysis/cycle_statistics.hpp"
#include "core/analysis/ladder.hpp"

namespace stickslip::analysis {

SectionSettings TestFit::section_settings() const {
  return {.scratch = settings_.scratch_folder,
          .first_counts = settings_.skipped.first_slip,
          .keep_fitted = !settings_.tester.transducer.is_ideal(),
          .keep_section = settings_.bootstrap.count > 0,
          .on_threads = !settings_.live};
}

TestEstimates TestFit::estimate(estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                                double sigma, const std::function<void()>& not_enough) {
  // Where the speed changes, the mean of a cycle does so too, without any drift of the paper.
  if (!settings_.skipped.drift && trace.belt.is_constant()) trace.drift = significant_drift(trace, slips);
  trace.belt.take_off_drift(trace.drift.rate_per_s);
  ErrorFactors factors;
  const auto estimates = [&](const estimate::SharedPrior& prior) {
    TestEstimates found =
        estimate_in_sections(trace, slips, sigma, prior, settings_.tester, section_settings());
    widen_errors(factors, found);
    return found;
  };
  TestEstimates alone = estimates({});
  if (!settings_.tester.transducer.is_ideal()) {
    const auto taken_off = take_off_transducer(trace, slips, sigma, alone);
    factors = taken_off.value_or(ErrorFactors{});
    transducer_is_off_ = taken_off.has_value();
  }
  if (alone.model_describes) tester_ = alone.tester;
  if (!alone.model_describes || (alone.misfit.is_significant() && trace.belt.is_constant())) not_enough();
  const auto held = [&](const estimate::SharedPrior& prior) {
    TestEstimates with = estimates(prior);
    with.rung = Rung::kTwoParameterLaw;
    with.rung_reason = alone.results.delta_mu.reason;
    return with;
  };
  if (!settings_.prior.coupling) {
    if (!alone.model_describes && trace.belt.has_one_speed()) {
      TestEstimates typical = held(held_damping(trace, slips));
      if (typical.model_describes && may_hold_damping(typical.results)) {
        tell_held_damping(typical.results);
        return typical;
      }
      // Where a fit stopped far from the best one, its residuals say nothing about the law.
      if (typical.misfit.residual_sigmas() < alone.misfit.residual_sigmas()) alone.misfit = typical.misfit;
    }
    return settings_.prior.empty() ? std::move(alone) : estimates(settings_.prior);
  }
  TestEstimates with = held(settings_.prior);
  if (!tester_ || !with.tester) return with;
  with.rung_reason = "the tester is characterised, and the damping found agrees with it";
  tester_check_ = check_tester(*tester_, *with.tester, *settings_.prior.coupling, settings_.tester);
  if (!tester_check_->used() || !with.model_describes) return alone;
  if (tester_check_->probability < kSlopeLevel) add_distance(alone.results, with.results);
  return with;
}

std::optional<ErrorFactors> TestFit::take_off_transducer(estimate::Trace& trace,
                                                         const base::LongColumn<detect::Fall>& slips,
                                                         double sigma, TestEstimates& estimates) const {
  const ThroughTransducer through{settings_.tester.transducer, 1.0 / settings_.scan_rate_Hz,
                                  settings_.scratch_folder};
  const auto fit = [&](const estimate::Trace& of, const base::LongColumn<detect::Fall>& own) {
    return estimate_in_sections(of, own, sigma, {}, settings_.tester, section_settings());
  };
  if (slips.size() > ThroughTransducer::kMostSlips) return std::nullopt;
  std::optional<TestEstimates> found =
      through.estimate(trace, estimates, [&](const estimate::Trace& of) { return fit(of, slips); });
  if (!found || !found->model_describes) return std::nullopt;
  const auto fit_own = [&](const estimate::Trace& of) {
    base::LongColumn<detect::Fall> own{settings_.scratch_folder};
    for (std::size_t i = 0; i < slips.size() && slips[i].trough_at + 1.0 < static_cast<double>(of.size());
         ++i)
      own.push_back(slips[i]);
    return own.empty() ? TestEstimates{} : fit(of, own);
  };
  std::optional<ErrorFactors> factors = through.error_factors(trace, *found, sigma, fit_own);
  if (!factors) return std::nullopt;
  trace.value = through.force(trace, *found);
  estimates = *std::move(found);
  widen_errors(*factors, estimates);
  return factors;
}

Estimate TestFit::mu_slope(const estimate::Trace& trace, const base::LongColumn<detect::Fall>& slips,
                           double sigma, const TestEstimates& estimates) const {
  if (!tester_)
    return Estimate::none(estimates.results.delta_mu.reason.empty() ? estimates.rung_reason
                                                                    : estimates.results.delta_mu.reason);
  if (!settings_.prior.coupling) {
    return Estimate::none(
        "the tester is not characterised: its damping and the paper's slope are one number, gamma");
  }
  const auto slope = [&](const TesterEstimate& found) {
    return slope_of_friction(found, *settings_.prior.coupling, settings_.tester.gravity_m_per_s2);
  };
  Estimate whole = slope(*tester_);
  if (!estimates.misfit.is_significant()) return whole;
  // What the law leaves out moves γ from one part of a test to the next.
  constexpr std::size_t kParts = 3;
  constexpr std::size_t kFewestSlips = 4;
  constexpr double kLeastAgreement = 0.01;
  const std::size_t size = slips.size() / kParts;
  if (size < kFewestSlips) {
    return Estimate::none(fmt::format("the fit leaves misfit, and {} slips make no {} parts that could agree",
                                      slips.size(), kParts));
  }
  std::vector<Estimate> parts;
  for (std::size_t part = 0; part < kParts; ++part) {
    base::LongColumn<detect::Fall> own{settings_.scratch_folder};
    for (std::size_t i = part * size; i < (part + 1) * size; ++i) own.push_back(slips[i]);
    const TestEstimates found =
        estimate_in_sections(trace, own, sigma, {}, settings_.tester, section_settings());
    if (!found.model_describes || !found.tester) {
      return Estimate::none(fmt::format("part {} of {} of the test has none: {}", part + 1, kParts,
                                        found.results.delta_mu.reason));
    }
    parts.push_back(slope(*found.tester));
    if (!parts.back().value || !parts.back().standard_error)
      return Estimate::none(
          fmt::format("part {} of {} of the test has none: {}", part + 1, kParts, parts.back().reason));
  }
  const double probability = probability_of_agreement(parts);
  if (probability >= kLeastAgreement) return whole;
  return Estimate::none(
      fmt::format("the {} parts of the test differ: {:.2g}, {:.2g} and {:.2g} s/m, probability {:.1g}",
                  kParts, *parts[0].value, *parts[1].value, *parts[2].value, probability));
}

Bootstrap TestFit::bootstrap(const estimate::Trace& trace, double sigma,
                             const TestEstimates& estimates) const {
  const auto none = [this](std::string reason) {
    return no_bootstrap(settings_.bootstrap, std::move(reason));
  };
  if (!estimates.model_describes) return none("no fit describes the test: " + estimates.rung_reason);
  if (transducer_is_off_)
    return none("load cell and filter are taken off: the drawings would not show their uncertainty");
  if (!estimates.section) return none(fmt::format("the test has more than {} slips", kMostSlipsTogether));
  return bootstrap_slips(trace, *estimates.section, sigma, estimates.prior, settings_.bootstrap);
}

}  // namespace stickslip::analysis
