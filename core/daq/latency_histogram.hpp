/// \file
/// Histogram of the delays of reads, in octaves. Fixed size; does not allocate; copyable.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace stickslip::daq {

/// Bin 0 counts delays below kFirstLimit_s. The upper limit doubles from bin to bin; the last bin has none.
class LatencyHistogram {
 public:
  static constexpr std::size_t kBins = 18;
  static constexpr double kFirstLimit_s = 16e-6;  ///< The last limit is then 1.05 s.
  using Counts = std::array<std::uint64_t, kBins>;

  LatencyHistogram() = default;
  /// Restores a stored histogram.
  LatencyHistogram(const Counts& counts, double largest_s) noexcept
      : counts_(counts), largest_s_(largest_s) {}

  /// Upper limit of a bin, s; infinite for the last.
  [[nodiscard]] static double limit_s(std::size_t bin) noexcept {
    return bin + 1 >= kBins ? HUGE_VAL : std::ldexp(kFirstLimit_s, static_cast<int>(bin));
  }

  /// \param late_ns  delay; a negative one counts as 0, since then the reference was late.
  void add(double late_ns) noexcept {
    const double late_s = std::max(0.0, 1e-9 * late_ns);
    std::size_t bin = 0;
    while (bin + 1 < kBins && late_s >= limit_s(bin)) ++bin;
    ++counts_[bin];
    largest_s_ = std::max(largest_s_, late_s);
    sum_s_ += late_s;
  }

  [[nodiscard]] const Counts& counts() const noexcept { return counts_; }
  [[nodiscard]] double largest_s() const noexcept { return largest_s_; }
  /// Sum of the delays added to this object. A restored histogram starts at 0, since records do not store the
  /// sum.
  [[nodiscard]] double sum_s() const noexcept { return sum_s_; }
  /// Compares the stored members: counts and largest delay.
  bool operator==(const LatencyHistogram& other) const noexcept {
    return counts_ == other.counts_ && largest_s_ == other.largest_s_;
  }

 private:
  Counts counts_{};
  double largest_s_ = 0.0;
  double sum_s_ = 0.0;
};

}  // namespace stickslip::daq
