#include "core/analysis/ladder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/model/tester.hpp"
#include "core/signal/statistics.hpp"

namespace stickslip::analysis {
namespace {

/// Q = r/(ω (S − K)) below which the belt's part of the amplitude, √((S − K)² + (r/ω)²), is less than 2 %:
/// then S − K is half the drop whatever the damping, which may be held. Near the threshold a wrong damping
/// would be taken for S − K.
constexpr double kSlow = 0.2;

/// What makes residuals in each part of the slip.
std::string_view likely_cause(SlipPart part) {
  switch (part) {
    case SlipPart::kRise:
      return "hum, missed spikes or creep before the slips";
    case SlipPart::kPeak:
      return "slips that begin gradually, or a slow transducer";
    case SlipPart::kFall:
      return "friction that changes with speed, or a slow transducer";
    case SlipPart::kTrough:
      return "a slow transducer, or friction that changes as the sled comes to rest";
  }
  return "friction";
}

}  // namespace

double total_error(const Estimate& estimate) {
  return std::hypot(estimate.standard_error.value_or(0.0), estimate.systematic_uncertainty.value_or(0.0));
}

void add_distance_to_fits(const base::LongColumn<detect::Cycle>& fitted, TestResults& results) {
  signal::RunningMean delta_mu;
  for (const detect::Cycle& row : fitted) {
    if (std::isfinite(row.delta_mu)) delta_mu.add(row.delta_mu);
  }
  if (delta_mu.count == 0.0 || !results.delta_mu.value) return;
  const double spread = std::abs(delta_mu.mean - *results.delta_mu.value);
  add_systematic(results.mu_s, UncertaintySource::kRung, spread);
  add_systematic(results.delta_mu, UncertaintySource::kRung, spread);
}

void add_distance(const TestResults& other_rung, TestResults& results) {
  const auto add = [](const Estimate& other, Estimate& estimate) {
    if (other.value && estimate.value)
      add_systematic(estimate, UncertaintySource::kRung, *other.value - *estimate.value);
  };
  add(other_rung.mu_s, results.mu_s);
  add(other_rung.mu_k, results.mu_k);
  add(other_rung.delta_mu, results.delta_mu);
}

void add_distance_to_mean_force(const Estimate& mean_force, TestResults& results) {
  if (!mean_force.value || !results.mu_k.value) return;
  const double distance = *mean_force.value - *results.mu_k.value;
  add_systematic(results.mu_k, UncertaintySource::kRung, distance);
  if (results.mu_s.systematic_parts[UncertaintySource::kBound])
    add_systematic(results.mu_s, UncertaintySource::kRung, distance);
}

bool may_hold_damping(const TestResults& results) { return results.Q.value.value_or(kSlow) < kSlow; }

void tell_held_damping(TestResults& results) {
  const double shift =
      0.5 * std::numbers::pi * model::kTypicalGammaOver2Omega * results.amplitude.value.value_or(0.0);
  add_systematic(results.mu_k, UncertaintySource::kDamping, shift);
  add_systematic(results.delta_mu, UncertaintySource::kDamping, shift);
  const Estimate none =
      Estimate::none(fmt::format("the damping is held at gamma/2omega = {}, typical of a sled on a spring",
                                 model::kTypicalGammaOver2Omega));
  for (Estimate* estimate : {&results.gamma_over_2omega, &results.Q_threshold, &results.threshold_speed,
                             &results.slip_speed_ratio_threshold})
    *estimate = none;
}

bool may_never_have_stuck(const TesterEstimate& tester, const TestResults& results) {
  constexpr double kNear = 0.9;
  if (!results.mu_k.value) return false;
  const double omega0_squared =
      tester.omega * tester.omega * (1.0 + tester.gamma_over_2omega * tester.gamma_over_2omega);
  return tester.speed_over_gravity_s * omega0_squared > kNear * tester.omega * *results.mu_k.value;
}

void void_start(const TesterEstimate& tester, double gravity_m_per_s2, TestResults& results) {
  const double fastest_m_per_s = results.mu_k.value.value_or(0.0) * gravity_m_per_s2 / tester.omega;
  const std::string why = fmt::format(
      "the belt is about as fast as the {:.3g} m/s, K g/omega, up to which a sled comes to rest on it before "
      "the first slip: the force may have swung about K from the start on",
      fastest_m_per_s);
  for (Estimate* estimate : {&results.static_coefficient, &results.mu_s, &results.delta_mu, &results.Q,
                             &results.threshold_speed, &results.pull_speed_measured})
    *estimate = Estimate::none(why);
  base::add(results.findings,
            base::make_finding(base::FindingCode::kFastBelt, "static, S and S - K are not given: " + why,
                               {{"fastest_speed", fastest_m_per_s, "m/s"}}));
}

void tell_bound(double bound, TestResults& results) {
  const double half = 0.5 * bound;
  results.delta_mu = Estimate::of(half);
  add_systematic(results.delta_mu, UncertaintySource::kBound, half);
  if (results.mu_k.value) {
    results.mu_s = Estimate::of(*results.mu_k.value + half);
    results.mu_s.systematic_uncertainty = results.mu_k.systematic_uncertainty;
    results.mu_s.systematic_parts = results.mu_k.systematic_parts;
    add_systematic(results.mu_s, UncertaintySource::kBound, half);
  }
  results.Q = results.threshold_speed = Estimate::none("S - K is not told from zero");
}

void take_misfit(const Misfit& misfit, TestResults& results) {
  results.misfit = misfit.systematic();
  if (const auto place = misfit.place())
    results.misfit_place = kSlipPartNames[static_cast<std::size_t>(*place)];
}

base::Finding turning_points_finding(const Estimate& delta_mu, const std::string& why) {
  constexpr auto kCode = base::FindingCode::kNotFitted;
  if (!delta_mu.value)
    return base::make_finding(kCode, fmt::format("S and K have no value, as {}; nor by turning points", why));
  const double error = total_error(delta_mu);
  return base::make_finding(
      kCode, fmt::format("S and K are by turning points, S - K uncertain by {:.2g}, as {}", error, why),
      {{"delta_mu_uncertainty", error, "1"}});
}

base::Finding misfit_finding(const Misfit& misfit, const TestResults& results) {
  const std::optional<SlipPart> part = misfit.place();
  const double uncertainty = total_error(results.delta_mu);
  std::vector<base::FindingNumber> numbers{{"residual", misfit.residual_sigmas(), "1"}};
  std::string text;
  std::string cause = "slips that begin gradually, another law of friction, or a slow transducer";
  if (part) {
    numbers.push_back({"residual_of_part", misfit.residual_sigmas(*part), "1"});
    cause = likely_cause(*part);
  }
  numbers.push_back({"delta_mu_uncertainty", uncertainty, "1"});
  if (misfit.repeats()) {
    const double size = std::sqrt(misfit.mean().square());
    numbers.push_back({"repeating_residual", size, "1"});
    text = fmt::format("each slip differs from the fit in the same way, by {:.2f} times the scan noise (rms)",
                       size);
    const auto swing = misfit.mean().swing();
    if (swing && results.omega.value) {
      const double frequency_Hz = *swing * *results.omega.value / (2.0 * std::numbers::pi);
      numbers.push_back({"swing_frequency", frequency_Hz, "Hz"});
      text += fmt::format(", swinging at {:.3g} Hz", frequency_Hz);
      cause = "a load cell or mounting that rings, or a filter that is slow for this oscillation";
    } else if (part) {
      text += fmt::format(", most in the {}", kSlipPartNames[static_cast<std::size_t>(*part)]);
    }
  } else {
    text = fmt::format("the fit leaves residuals of {:.2f} times the scan noise", misfit.residual_sigmas());
    if (part) {
      text += fmt::format(", {:.2f} in the {} of the slips", misfit.residual_sigmas(*part),
                          kSlipPartNames[static_cast<std::size_t>(*part)]);
    }
  }
  text += fmt::format(
      "; a likely cause is {}; S - K is uncertain by {:.2g}, its distance to turning points "
      "included",
      cause, uncertainty);
  return base::make_finding(base::FindingCode::kMisfit, std::move(text), std::move(numbers));
}

}  // namespace stickslip::analysis
