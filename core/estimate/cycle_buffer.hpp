/// \file
/// Compressed scans of one cycle: recent scans singly, older ones as means of blocks, in fixed memory.
///
///     CycleBuffer buffer;
///     buffer.add(time_s, coefficient);
///     for (const CyclePoint& point : buffer.since(onset_s)) …
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/estimate/trace.hpp"

namespace stickslip::estimate {

/// Mean over a block of consecutive scans. Members have no initial values, so that an array of points costs
/// nothing.
struct CyclePoint {
  double time_s;     ///< Mean of their times.
  double value;      ///< Mean of their coefficients.
  double spread_s2;  ///< Variance of their times about the mean; 0 for one scan.
  double count;      ///< Number of scans; the mean has the variance σ²/count.
  double first_s;    ///< Time of the first of them.
  double last_s;     ///< Time of the last of them.
};

/// Holds at most kMostPoints points, whatever the scan rate and the length of the stick. When it is full,
/// neighbouring points are merged into blocks. A block is at most as long as a fraction of its age: 1/64 if
/// that leaves room, 1 at worst. This loses little of a stick, whose mean lies on its line. keep_fine()
/// limits the blocks of a slip under way. The mean of a curved trajectory differs from its value at the mean
/// time by c″·spread/2 + O(c⁗ h⁴/1920) for a block of length h. A comparison must add the first term; the
/// rest is below 10⁻⁴ of the amplitude for blocks of a tenth of an oscillation. Never allocates. add() is
/// amortised O(1) and at worst a few passes over kMostPoints points.
class CycleBuffer {
 public:
  static constexpr std::size_t kMostPoints = 256;

  /// \param time_s  rises from call to call. Leave out unusable scans.
  void add(double time_s, double value) noexcept { add({time_s, value, 0.0, 1.0, time_s, time_s}); }
  /// Limits the length of blocks that overlap [from_s, to_s] to longest_s in later merges. Replaces the limit
  /// of an earlier call. The limit is dropped if the buffer overflows with it.
  void keep_fine(double from_s, double to_s, double longest_s) noexcept;
  /// Removes the points that end before time_s.
  void forget_before(double time_s) noexcept;
  /// Removes all points. The limit of keep_fine() stays.
  void clear() noexcept { size_ = 0; }

  /// All points, oldest first. Spans are valid until the buffer is changed.
  [[nodiscard]] std::span<const CyclePoint> points() const noexcept { return {points_.data(), size_}; }
  /// Points that begin at time_s or later.
  [[nodiscard]] std::span<const CyclePoint> since(double time_s) const noexcept;

 private:
  void add(const CyclePoint& point) noexcept;
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
/// \param points  in the order of time.
[[nodiscard]] std::span<const CyclePoint> between(std::span<const CyclePoint> points, double from_s,
                                                  double to_s) noexcept;

/// Replaces the contents by the usable scans [first, end) of a trace, without the drift. In the period_s
/// after scan `first` blocks are at most period_s/40 long, by keep_fine(). [first, end) must not be empty.
void read_slip(CycleBuffer& buffer, const Trace& trace, std::size_t first, std::size_t end, double period_s);

}  // namespace stickslip::estimate
