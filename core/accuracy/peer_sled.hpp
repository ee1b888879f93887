/// \file
/// Common part of the stepping methods: forces on the sled, and Coulomb friction.
#pragma once

#include <cmath>

#include "core/accuracy/reference.hpp"
#include "core/sim/motion.hpp"

namespace stickslip::accuracy {

/// Forces on the sled in units of the coefficient c: c″ = pull(c, c′) + ω₀² μ. The method that uses this adds
/// the friction μ: ±K while the sled slides, or that of make_tanh().
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
  double damper_share_s;  ///< γ/ω₀² if the damper's force counts at the onset; else 0.

  /// Acceleration c″ by the coupling, 1/s²; 0 where a one-way coupling is slack.
  [[nodiscard]] double pull(double c, double rate) const {
    return one_way && c < 0.0 ? 0.0 : -omega0_squared * c - gamma * rate;
  }
  /// Force of the spring as a coefficient; 0 where a one-way coupling is slack.
  [[nodiscard]] double spring(double c) const { return one_way && c < 0.0 ? 0.0 : c; }
  /// Whether static friction can hold the sled on a belt of this rate, 1/s.
  [[nodiscard]] bool holds(double c, double belt_rate) const {
    return std::abs(spring(c) + damper_share_s * belt_rate) <= S;
  }
  /// c at scan 0: 0, or below zero by the slack.
  [[nodiscard]] static double start_c(const sim::Motion& motion) {
    return -motion.startup_slack_m * motion.oscillator.omega0_squared() / motion.gravity_m_per_s2;
  }
  /// c′ at scan 0, 1/s: that of the belt in the first segment if the coupling is slack, else 0.
  [[nodiscard]] static double start_rate(const sim::Motion& motion) {
    if (motion.startup_slack_m == 0.0 || motion.belt.empty()) return 0.0;
    return motion.oscillator.stick_rate_per_s(motion.belt.front().speed_m_per_s, motion.gravity_m_per_s2);
  }
};

}  // namespace stickslip::accuracy
