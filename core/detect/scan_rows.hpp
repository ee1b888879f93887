/// \file
/// The latest scans as rows at equal intervals; each row is the mean of the same number of scans.
///
///     ScanRows rows{scan_s};
///     rows.add(coefficient, usable);
///     rows.restart(4);  // From now on, four scans a row.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/estimate/cycle_buffer.hpp"

namespace stickslip::detect {

/// A row that contains an unusable scan has weight 0 and keeps its place. Fixed size; never allocates.
class ScanRows {
 public:
  /// Number of stored rows.
  static constexpr std::size_t kMost = 256;

  struct Row {
    double value;
    double weight;  ///< 1, or 0 if a scan of it is not usable.
  };

  /// \param scan_s  from scan to scan, > 0.
  explicit ScanRows(double scan_s) noexcept;

  /// The next scan.
  void add(double value, bool usable) noexcept {
    sum_ += value;
    usable_ = usable_ && usable;
    if (++in_row_ < scans_) return;
    const auto scans = static_cast<double>(scans_);
    rows_[count_++ % kMost] = {scans_ == 1 ? sum_ : sum_ / scans, usable_ ? 1.0 : 0.0};
    in_row_ = 0;
    sum_ = 0.0;
    usable_ = true;
  }
  /// Removes all rows.
  /// \param scans  per row from now on, > 0.
  void restart(std::size_t scans) noexcept;

  [[nodiscard]] double scan_s() const noexcept { return scan_s_; }
  [[nodiscard]] std::size_t scans_per_row() const noexcept { return scans_; }
  [[nodiscard]] double row_s() const noexcept { return static_cast<double>(scans_) * scan_s_; }
  /// Number of rows completed since the restart; the last kMost are stored.
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// \param number  counted from the restart.
  [[nodiscard]] const Row& operator[](std::size_t number) const noexcept { return rows_[number % kMost]; }
  /// Mean time of the latest row. \param now_s  of the last scan.
  [[nodiscard]] double newest_s(double now_s) const noexcept {
    return now_s - (static_cast<double>(in_row_) + 0.5 * (static_cast<double>(scans_) - 1.0)) * scan_s_;
  }

  /// Visits the usable rows that begin at since_s or later, oldest first. \param now_s  of the last scan.
  /// \param use  called with a CyclePoint.
  template <typename Use>
  void for_each_since(double since_s, double now_s, const Use& use) const {
    const auto scans = static_cast<double>(scans_);
    const double length_s = (scans - 1.0) * scan_s_;
    const double spread_s2 = (scans * scans - 1.0) / 12.0 * scan_s_ * scan_s_;
    for (std::size_t back = std::min(count_, kMost); back-- > 0;) {
      const Row& row = (*this)[count_ - 1 - back];
      const double time_s = newest_s(now_s) - static_cast<double>(back) * row_s();
      const double first_s = time_s - 0.5 * length_s;
      if (row.weight == 0.0 || first_s < since_s) continue;
      use(estimate::CyclePoint{time_s, row.value, spread_s2, scans, first_s, first_s + length_s});
    }
  }

 private:
  double scan_s_;
  std::size_t scans_;
  std::size_t in_row_ = 0;
  double sum_ = 0.0;
  bool usable_ = true;
  std::size_t count_ = 0;
  std::array<Row, kMost> rows_;  ///< Those that came: see count_.
};

}  // namespace stickslip::detect
