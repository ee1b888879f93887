/// \file
/// The latest few values of a stream, contiguous in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace stickslip::signal {

/// The last kWidth values, oldest first; zeros before the first. The window moves through a buffer of several
/// widths and is copied back to its start only at the end: shifting at each scan would cost more than most
/// uses of the window.
template <std::size_t kWidth>
class SlidingWindow {
 public:
  void push(double value) noexcept {
    if (end_ == room_.size()) {
      std::copy(room_.end() - (kWidth - 1), room_.end(), room_.begin());
      end_ = kWidth - 1;
    }
    room_[end_++] = value;
  }

  /// Valid until the next push(). A changed value stays changed while it is in the window.
  [[nodiscard]] std::span<const double, kWidth> values() const noexcept {
    return std::span<const double, kWidth>{room_.data() + (end_ - kWidth), kWidth};
  }
  [[nodiscard]] std::span<double, kWidth> values() noexcept {
    return std::span<double, kWidth>{room_.data() + (end_ - kWidth), kWidth};
  }

 private:
  static constexpr std::size_t kRoom = 16 * kWidth;

  std::array<double, kRoom> room_{};
  std::size_t end_ = kWidth;
};

}  // namespace stickslip::signal
