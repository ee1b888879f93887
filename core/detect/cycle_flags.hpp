/// \file
/// Flags of the cycle under way: which scans belong to it is known only at the next peak.
#pragma once

#include <cstdint>
#include <limits>

namespace stickslip::detect {

/// The highest scan since the last slip may be the next peak. A flag of a scan up to it belongs to the cycle
/// under way, one of a scan after it to the next.
class CycleFlags {
 public:
  /// A scan or a gap before it has these flags (detect/cycle.hpp).
  void mark(std::uint8_t flags) noexcept { after_ |= flags; }
  void add(double value) noexcept {
    if (!(value > highest_)) return;
    highest_ = value;
    to_highest_ |= after_;
    after_ = 0;
  }
  /// The highest scan was the peak of a slip: those before it belong to the cycle that ends there.
  void end_cycle_at_peak() noexcept { cycle_ |= to_highest_; }
  /// The cycle that begins at that peak.
  void begin_cycle() noexcept {
    cycle_ = after_;
    to_highest_ = after_ = 0;
    highest_ = -std::numeric_limits<double>::infinity();
  }
  /// Nothing follows.
  void end_test() noexcept { cycle_ |= to_highest_ | after_; }
  [[nodiscard]] std::uint8_t of_cycle() const noexcept { return cycle_; }

 private:
  double highest_ = -std::numeric_limits<double>::infinity();  ///< Scan since the last slip.
  std::uint8_t to_highest_ = 0;
  std::uint8_t after_ = 0;
  std::uint8_t cycle_ = 0;
};

}  // namespace stickslip::detect
