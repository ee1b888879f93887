/// \file
/// A tester that was characterised, with the error that a characterisation has.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "core/estimate/shared_prior.hpp"

namespace stickslip::test {

/// ω and γ/2ω as one ring-down of 1.5 s tells them: each off by a normal number of its own standard error,
/// 0.013 % and 0.51 % (docs/detector-limits.md), other ones for each seed. \param omega  rad/s, true.
/// \param gamma_over_2omega  true.
inline estimate::SharedPrior characterised(double omega, double gamma_over_2omega, std::uint64_t seed) {
  constexpr double kOmegaPart = 1.3e-4;
  constexpr double kGammaPart = 5.1e-3;
  std::mt19937_64 engine{seed ^ 0xc4a2'ac7e'215e'd000U};  // A stream beside that of the scans.
  std::normal_distribution<double> normal;
  estimate::SharedPrior prior;
  prior.coupling = estimate::SharedPrior::Coupling{};
  prior.coupling->omega = omega * (1.0 + kOmegaPart * normal(engine));
  prior.coupling->gamma_over_2omega = gamma_over_2omega * (1.0 + kGammaPart * normal(engine));
  prior.coupling->covariance =
      Eigen::Vector2d{std::pow(kOmegaPart * omega, 2), std::pow(kGammaPart * gamma_over_2omega, 2)}
          .asDiagonal();
  return prior;
}

}  // namespace stickslip::test
