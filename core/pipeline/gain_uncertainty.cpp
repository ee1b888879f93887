#include "core/pipeline/gain_uncertainty.hpp"

#include <cmath>

namespace stickslip::pipeline {

std::optional<double> relative_gain_uncertainty(const std::optional<daq::LoadCell>& load_cell,
                                                std::optional<double> standard_error_N_per_V) {
  if (!load_cell || !standard_error_N_per_V) return std::nullopt;
  return std::abs(*standard_error_N_per_V / load_cell->gain_N_per_V);
}

void add_gain_uncertainty(analysis::TestResults& results, std::optional<double> relative) {
  if (!relative) return;
  // Proportional to the gain, or (Q) to its inverse.
  for (analysis::Estimate* estimate :
       {&results.static_coefficient, &results.kinetic_coefficient, &results.mu_s, &results.mu_k,
        &results.delta_mu, &results.amplitude, &results.delta_mu_scatter, &results.drift_rate,
        &results.delta_mu_from_amplitude, &results.delta_mu_from_timing, &results.delta_mu_from_slip_speed,
        &results.delta_mu_combined, &results.mu_k_from_mean, &results.mu_s_from_amplitude,
        &results.threshold_speed, &results.Q, &results.pull_speed_measured}) {
    if (estimate->value)
      add_systematic(*estimate, analysis::UncertaintySource::kCalibration, *relative * *estimate->value);
  }
}

}  // namespace stickslip::pipeline
