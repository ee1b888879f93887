#include "core/analysis/quantities.hpp"

namespace stickslip::analysis {

const std::array<Quantity, kQuantityCount>& quantities() noexcept {
  static constexpr std::array<Quantity, kQuantityCount> kQuantities{{
      {"static_coefficient", "static", "1", 4, &TestResults::static_coefficient},
      {"kinetic_coefficient", "kinetic", "1", 4, &TestResults::kinetic_coefficient},
      {"mu_s", "S", "1", 4, &TestResults::mu_s},
      {"mu_k", "K", "1", 4, &TestResults::mu_k},
      {"delta_mu", "S−K", "1", 4, &TestResults::delta_mu},
      {"amplitude", "amplitude", "1", 4, &TestResults::amplitude},
      {"oscillation_frequency", "frequency", "Hz", 3, &TestResults::oscillation_frequency},
      {"gamma_over_2omega", "γ/2ω", "1", 5, &TestResults::gamma_over_2omega},
  }};
  return kQuantities;
}

}  // namespace stickslip::analysis
