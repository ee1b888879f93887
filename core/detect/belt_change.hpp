/// \file
/// Has the belt got another speed, or were there spikes in the rise that says so?
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/detect/live_junction.hpp"

namespace stickslip::detect {

/// Change of ln r from which on the belt has another speed.
inline constexpr double kStickRateChange = 0.05;

/// Rises of the force whose slope is not the stick rate known. One may hold spikes that were not found; of
/// two in a row that agree, it is the belt.
class BeltChange {
 public:
  /// A slip that the stick rate known does not describe. \param slip  its number. \param rate  slope of the
  /// rise before it, > 0. \return the slip before was one too, and agrees.
  [[nodiscard]] bool seen(std::int64_t slip, double rate) noexcept {
    if (slip != latest_.slip) {
      before_ = latest_;
      latest_ = {slip, rate};
    }
    return before_.slip + 1 == slip && std::abs(std::log(rate / before_.rate)) < kStickRateChange;
  }

  /// Whether another stick rate is what a misfit comes from: with it the scans are described, or half of the
  /// misfit is gone. A spike that was not found leaves most of its misfit whatever the speed.
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
