/// \file
/// Common part of the stepping methods: forces on the sled, and Coulomb friction.
#pragma once

#include <cmath>

#include "core/accuracy/reference.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::accuracy {

/// Forces on the sled in units of the coefficient c: c″ = pull(c, c′) + ω₀² μ, where μ is ±K while it slides.
struct PeerSled {
  explicit PeerSled(const sim::Motion& motion)
      : omega0_squared(motion.oscillator.omega0_squared()),
        gamma(motion.oscillator.gamma_per_s),
        S(motion.mu_s),
        K(motion.mu_k),
        one_way(motion.one_way_coupling),
        damper_share_s(motion.damper_counts_at_onset ? gamma / omega0_squared : 0.0) {}

  double omega0_squared, gamma, S, K;
  bool one_way;
  double damper_share_s;

  /// Acceleration c″ by the coupling.
  [[nodiscard]] double pull(double c, double rate) const {
    return one_way && c < 0.0 ? 0.0 : -omega0_squared * c - gamma * rate;
  }
  [[nodiscard]] double spring(double c) const { return one_way && c < 0.0 ? 0.0 : c; }
  /// Can static friction hold the sled on a belt of this rate?
  [[nodiscard]] bool holds(double c, double belt_rate) const {
    return std::abs(spring(c) + damper_share_s * belt_rate) <= S;
  }
  [[nodiscard]] static double start_c(const sim::Motion& motion) {
    return -motion.startup_slack_m * motion.oscillator.omega0_squared() / motion.gravity_m_per_s2;
  }
};

}  // namespace stickslip::accuracy
