/// \file
/// Settings of the transducer stage: response of the voltage to the force.
#pragma once

namespace stickslip::sim {

/// Effect `load_cell`: y″ + 2ζω y′ + ω² y = ω² (the force).
struct LoadCellDynamics {
  double frequency_Hz = 0.0;   ///< ω/2π, natural, without damping.
  double damping_ratio = 0.0;  ///< ζ > 0
};

/// Effect `anti_alias`: a Butterworth low-pass; of order 1 it is an RC filter.
struct AntiAlias {
  static constexpr int kHighestOrder = 8;
  double cutoff_Hz = 0.0;  ///< Where the gain is 1/√2.
  int order = 1;           ///< 1 … kHighestOrder
};

}  // namespace stickslip::sim
