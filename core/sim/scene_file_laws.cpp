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

// Ranges leave room around what has been measured. No source measures these laws for paper on this tester, so
// that there are few defaults.
//
// Penner's (1995) model has the same K at 3 to 12 in/min (1.3 to 5.1 mm/s); the dependence in his Fig. 1 he
// puts down to drift. All of K = 0.3 lost over these speeds would be 80 s/m.
constexpr double kSteepest_s_per_m = 1000.0;
// Speeds: from an atom's diameter in a few minutes, below the plates of the Earth (some 1e-9 m/s) for which
// these laws are used [Marone, Annu. Rev. Earth Planet. Sci. 26:643–696, 1998], to the fastest belt of a
// scene.
constexpr double kSlowest_m_per_s = 1e-12;
constexpr double kFastest_m_per_s = 10.0;
// Exponent of Stribeck's curve: 1 [Tustin, 1947] and 2 (Gaussian) are those in use, and 1/2 to 1 and far
// above have been proposed [Armstrong-Hélouvry, Dupont and Canudas de Wit, Automatica 30(7):1083–1138, 1994].
constexpr double kLeastExponent = 0.5;
constexpr double kGreatestExponent = 4.0;
constexpr double kGaussianExponent = 2.0;
// a and b of rocks are around 0.01 [Dieterich, J. Geophys. Res. 84(B5):2161–2168, 1979; Marone 1998]. a = 0
// would leave the regularised law [Lapusta et al. 2000] without a speed at which it holds a given force.
constexpr double kLeastDirectEffect = 1e-4;
constexpr double kGreatestEffect = 1.0;
// D_c: about 1 µm of paper on paper [Heslot, Baumberger, Perrin, Caroli and Caroli, Phys. Rev. E
// 49:4973–4988, 1994], 1 to 100 µm of rocks in the laboratory [Marone 1998].
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
  stribeck.exponent = effect.quantity("exponent", Dimension::kDimensionless,
                                      Limits::between(kLeastExponent, kGreatestExponent), kGaussianExponent);
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
  law.a =
      effect.quantity("a", Dimension::kDimensionless, Limits::between(kLeastDirectEffect, kGreatestEffect));
  law.b = effect.quantity("b", Dimension::kDimensionless, Limits::between(0.0, kGreatestEffect));
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
