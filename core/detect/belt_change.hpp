/// \file
/// Detects a change of the belt's speed from the slopes of rises, and distinguishes it from spikes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/detect/capture_test.hpp"

namespace stickslip::detect {

/// Smallest change of ln r that counts as another belt speed; stick rates closer than this agree.
inline constexpr double kStickRateChange = 0.05;

/// Registers rises whose slope differs from the known stick rate. A single one may be caused by missed
/// spikes; two in a row that agree show a new belt speed.
class BeltChange {
 public:
  /// Registers a slip that the known stick rate does not describe; of several calls for one slip, the first.
  /// \param slip  its number, one more than that of the slip before.
  /// \param rate  slope of the rise before it, 1/s, > 0.
  /// \return whether the slip before was registered too, with a rate that agrees (kStickRateChange).
  [[nodiscard]] bool seen(std::int64_t slip, double rate) noexcept {
    if (slip != latest_.slip) {
      before_ = latest_;
      latest_ = {slip, rate};
    }
    return before_.slip + 1 == slip && std::abs(std::log(rate / before_.rate)) < kStickRateChange;
  }

  /// Whether another stick rate explains a misfit: it makes the residuals smaller, and brings them below
  /// kMisfitSigmas or below half of what they were. A missed spike leaves most of the misfit at any rate.
  /// \param residual_sigmas  standard deviation of the residuals with the other rate, in σ.
  /// \param before_sigmas    with the known rate, in σ.
  [[nodiscard]] static bool explains(double residual_sigmas, double before_sigmas) noexcept {
    return residual_sigmas < std::min(before_sigmas, std::max(kMisfitSigmas, 0.5 * before_sigmas));
  }

 private:
  struct Rise {
    std::int64_t slip = -2;  ///< No slip follows that number.
    double rate = 0.0;
  };
  Rise latest_;
  Rise before_;
};

}  // namespace stickslip::detect
