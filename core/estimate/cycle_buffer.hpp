/// \file
/// The scans of one cycle in little room: few at full resolution, the others as means of blocks.
///
///     CycleBuffer buffer;
///     buffer.add(time_s, coefficient);
///     for (const CyclePoint& point : buffer.since(onset_s)) …
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace stickslip::estimate {

/// Mean of consecutive scans. Without initial values: an array of them needs none.
struct CyclePoint {
  double time_s;     ///< Mean of their times.
  double value;      ///< Mean of their coefficients.
  double spread_s2;  ///< Variance of their times about the mean; 0 for one scan.
  double count;      ///< How many; the mean has σ²/count.
  double first_s;    ///< Time of the first of them.
  double last_s;     ///< Time of the last of them.
};

/// At most kMostPoints points, whatever the scan rate and the length of the stick. When they are full,
/// neighbours are merged, and a block may be as long as a part of its age: what lies one oscillation back is
/// kept by eighths of it or better however many scans it has, and the line of a stick, whose mean lies on
/// it, costs little. What must be kept finer for longer, a slip under way, is told by keep_fine().
/// The mean of a curved course differs from the value at the mean time by c″·spread/2 + O(c⁗ h⁴/1920) for a
/// block of length h: who compares them adds the first, and the rest is below 10⁻⁴ of the amplitude for
/// blocks of a tenth of an oscillation. Never allocates; add() is amortised O(1), at most kMostPoints steps a
/// few times.
class CycleBuffer {
 public:
  static constexpr std::size_t kMostPoints = 256;

  /// \param time_s  rises from call to call. Scans that are not to be used are not added.
  void add(double time_s, double value) noexcept { add({time_s, value, 0.0, 1.0, time_s, time_s}); }
  void add(const CyclePoint& point) noexcept;
  /// Blocks in [from_s, to_s] grow no longer than longest_s. The latest call counts.
  void keep_fine(double from_s, double to_s, double longest_s) noexcept;
  /// Leaves out the points that end before.
  void forget_before(double time_s) noexcept;
  void clear() noexcept { size_ = 0; }

  [[nodiscard]] std::span<const CyclePoint> points() const noexcept { return {points_.data(), size_}; }
  /// Those that begin at time_s or later.
  [[nodiscard]] std::span<const CyclePoint> since(double time_s) const noexcept;

 private:
  /// Merges neighbours whose block is at most its age over `resolution` long. \return points left.
  [[nodiscard]] std::size_t merged_count(double resolution) const noexcept;
  void merge(double resolution) noexcept;
  [[nodiscard]] bool may_merge(const CyclePoint& before, const CyclePoint& after,
                               double resolution) const noexcept;
  void compact() noexcept;

  std::array<CyclePoint, kMostPoints> points_;  ///< Oldest first.
  std::size_t size_ = 0;
  double fine_from_s_ = 0.0;
  double fine_to_s_ = 0.0;
  double fine_longest_s_ = 0.0;
};

/// Points of a span whose mean time lies in [from_s, to_s).
[[nodiscard]] std::span<const CyclePoint> between(std::span<const CyclePoint> points, double from_s,
                                                  double to_s) noexcept;

}  // namespace stickslip::estimate
