#include <array>
#include <string_view>
#include <utility>

#include "core/base/wording.hpp"
#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {

using base::Dimension;
using base::Limits;
using base::Settings;

namespace {

constexpr double kSteepest_s_per_m = 1000.0;
constexpr double kSlowest_m_per_s = 1e-12;  // An atom in a minute or so.
constexpr double kFastest_m_per_s = 10.0;
constexpr double kSmallestDirectEffect = 1e-4;  // Of a; measured ones are around 0.01.
constexpr double kShortestCriticalSlip_m = 1e-8;
constexpr double kLongestCriticalSlip_m = 0.1;

double read_velocity_dependence(Settings effect) {
  return effect.quantity("per_speed", Dimension::kTimePerLength,
                         Limits::between(-kSteepest_s_per_m, kSteepest_s_per_m));
}

Stribeck read_stribeck(Settings effect, const Scene& scene) {
  Stribeck stribeck;
  stribeck.rise =
      effect.quantity("rise", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient));
  stribeck.speed_m_per_s =
      effect.quantity("speed", Dimension::kSpeed, Limits::between(kSlowest_m_per_s, kFastest_m_per_s));
  stribeck.exponent = effect.quantity("exponent", Dimension::kDimensionless, Limits::between(0.5, 4.0), 2.0);
  if (stribeck.rise > scene.mu_s - scene.mu_k) {
    effect.refuse("rise", fmt::format("must not be above mu_s - mu_k = {}, or S would be below K at rest",
                                      scene.mu_s - scene.mu_k));
  }
  return stribeck;
}

RateAndState read_rate_and_state(Settings effect, const Scene& scene) {
  constexpr std::array<std::pair<std::string_view, RateAndState::Law>, 2> kLaws{
      {{"ageing", RateAndState::Law::kAgeing}, {"slip", RateAndState::Law::kSlip}}};
  RateAndState law;
  law.law = effect.choice<RateAndState::Law>("law", kLaws);
  law.a = effect.quantity("a", Dimension::kDimensionless, Limits::between(kSmallestDirectEffect, 1.0));
  law.b = effect.quantity("b", Dimension::kDimensionless, Limits::between(0.0, 1.0));
  law.critical_slip_m = effect.quantity("critical_slip", Dimension::kLength,
                                        Limits::between(kShortestCriticalSlip_m, kLongestCriticalSlip_m));
  law.reference_speed_m_per_s = effect.quantity("reference_speed", Dimension::kSpeed,
                                                Limits::between(kSlowest_m_per_s, kFastest_m_per_s));
  law.mu_0 = effect.quantity("mu_0", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient),
                             scene.mu_k);
  return law;
}

}  // namespace

void read_friction_laws(Settings effects, Scene& scene) {
  if (lists(effects, "velocity_dependence")) {
    scene.velocity_dependence_s_per_m = read_velocity_dependence(effects.table("velocity_dependence"));
  }
  if (lists(effects, "stribeck")) scene.stribeck = read_stribeck(effects.table("stribeck"), scene);
  if (!lists(effects, "rate_and_state")) return;
  scene.rate_and_state = read_rate_and_state(effects.table("rate_and_state"), scene);
  // A law of its own, without the S and K that these change.
  constexpr std::array<std::string_view, 7> kOfCoulombFriction{
      "scatter",  "first_peak",       "contact_ageing", "velocity_dependence",
      "stribeck", "onset_convention", "kinetic_drift"};
  for (const std::string_view other : kOfCoulombFriction) {
    if (!effects.has(other)) continue;
    effects.refuse(other, fmt::format("must not stand beside rate_and_state, which has no S and K that {} "
                                      "could change",
                                      other));
    return;
  }
}

}  // namespace stickslip::sim
