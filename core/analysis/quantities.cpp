#include "core/analysis/quantities.hpp"

namespace stickslip::analysis {

const std::array<Quantity, kQuantityCount>& quantities() noexcept {
  static constexpr std::array<Quantity, kQuantityCount> kQuantities{{
      {"static_coefficient", "static", "1", 4, &TestResults::static_coefficient, "static µs",
       "static µs (ISO 8295: µS)", false},
      {"kinetic_coefficient", "kinetic", "1", 4, &TestResults::kinetic_coefficient, "kinetic µk",
       "kinetic (dynamic) µk", false},
      {"mu_s", "S", "1", 4, &TestResults::mu_s, "S", "S", true},
      {"mu_k", "K", "1", 4, &TestResults::mu_k, "K", "K", true},
      {"delta_mu", "S−K", "1", 4, &TestResults::delta_mu, "S−K", "S−K", true},
      {"amplitude", "amplitude", "1", 4, &TestResults::amplitude, "amplitude", "amplitude", false},
      {"oscillation_frequency", "frequency", "Hz", 3, &TestResults::oscillation_frequency, "ω/2π",
       "frequency ω/2π", true},
      {"gamma_over_2omega", "γ/2ω", "1", 5, &TestResults::gamma_over_2omega, "γ/2ω", "γ/2ω", true},
  }};
  return kQuantities;
}

}  // namespace stickslip::analysis
