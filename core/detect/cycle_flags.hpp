/// \file
/// Flags of the cycle under way: which scans belong to it is known only at the next peak.
#pragma once

#include <cstdint>
#include <limits>

namespace stickslip::detect {

/// Collects flags of scans and assigns them to cycles. The highest scan since the last slip may be the next
/// peak: flags of scans up to it belong to the cycle under way, flags of later scans to the next. For each
/// scan call mark(), if it has flags, then add(). At a slip call end_cycle_at_peak(), read of_cycle(), then
/// call begin_cycle().
class CycleFlags {
 public:
  /// The scan that add() gets next, or a gap before it, has these CycleFlag bits.
  void mark(std::uint8_t flags) noexcept { after_ |= flags; }
  /// The next scan.
  void add(double value) noexcept {
    if (!(value > highest_)) return;
    highest_ = value;
    to_highest_ |= after_;
    after_ = 0;
  }
  /// The highest scan was the peak of a slip: flags up to and with it belong to the cycle that ends there.
  void end_cycle_at_peak() noexcept { cycle_ |= to_highest_; }
  /// A cycle begins at that peak: flags of scans after it are its own.
  void begin_cycle() noexcept {
    cycle_ = after_;
    to_highest_ = after_ = 0;
    highest_ = -std::numeric_limits<double>::infinity();
  }
  /// No scan follows: all flags so far belong to the cycle under way.
  void end_test() noexcept { cycle_ |= to_highest_ | after_; }
  /// Flags assigned to the cycle under way so far.
  [[nodiscard]] std::uint8_t of_cycle() const noexcept { return cycle_; }

 private:
  double highest_ = -std::numeric_limits<double>::infinity();  ///< Scan since the last slip.
  std::uint8_t to_highest_ = 0;
  std::uint8_t after_ = 0;
  std::uint8_t cycle_ = 0;
};

}  // namespace stickslip::detect
