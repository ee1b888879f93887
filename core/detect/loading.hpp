/// \file
/// Detects the loading. A fall before it is no slip.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/detect/slip_rule.hpp"

namespace stickslip::detect {

/// Detects the loading: three scans in a row exceed the lowest one so far by more than the drop of a slip,
/// SlipRule::kSignificantSigmas.
class Loading {
 public:
  /// The next scan; not to be called after it returned true, which could move the begin.
  /// \param sigma  noise of one scan; infinite while unknown.
  /// \param count  scans so far, with this one and those that add() did not get.
  /// \return whether the loading is seen at this scan; it began two scans before, by `count`.
  bool add(double value, double sigma, std::int64_t count) noexcept {
    lowest_ = std::min(lowest_, value);
    above_ = value - lowest_ > SlipRule::kSignificantSigmas * sigma ? above_ + 1 : 0;
    if (above_ < kLoadedScans) return false;
    began_at_ = static_cast<double>(count - kLoadedScans);
    return true;
  }
  /// Whether a position, in scans after the first, is the begin of the loading or later. False until the
  /// loading is seen.
  [[nodiscard]] bool is_behind_begin(double position) const noexcept { return position >= began_at_; }

 private:
  static constexpr int kLoadedScans = 3;

  double lowest_ = std::numeric_limits<double>::infinity();
  int above_ = 0;  ///< Scans in a row.
  double began_at_ = std::numeric_limits<double>::infinity();
};

}  // namespace stickslip::detect
