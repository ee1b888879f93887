/// \file
/// Positions of scans in time, with gaps, behind a despiker that holds scans back.
#pragma once

#include <cstdint>

namespace stickslip::detect {

/// Converts positions of scans, counted without missing ones, into times. A scan comes when it is added, and
/// is followed when the despiker lets it go, a few scans later: a gap is known before all scans that precede
/// it are followed. Remembers the last gap and what was lost before it.
class ScanPositions {
 public:
  explicit ScanPositions(double scan_rate_Hz) noexcept : scan_rate_Hz_(scan_rate_Hz) {}

  /// A scan comes. \return how many came before it: its position.
  std::int64_t come() noexcept { return come_++; }
  /// The next scan is followed. \return its position.
  std::int64_t follow() noexcept { return followed_++; }
  [[nodiscard]] std::int64_t count_come() const noexcept { return come_; }
  [[nodiscard]] std::int64_t count_followed() const noexcept { return followed_; }

  /// There was a gap, and no scan after the last one was followed yet.
  [[nodiscard]] bool is_gap_to_come() const noexcept { return followed_ <= gap_at_ && lost_ > lost_before_; }
  /// The scan to be followed next is the first behind the last gap.
  [[nodiscard]] bool is_at_gap() const noexcept { return followed_ == gap_at_ && is_gap_to_come(); }
  /// Whether a gap added now continues the last one: no scan came in between.
  [[nodiscard]] bool continues_gap() const noexcept { return is_gap_to_come() && come_ == gap_at_; }
  /// `count` scans are missing before the one that comes next.
  void add_gap(std::int64_t count) noexcept {
    if (!continues_gap()) {
      lost_before_ = lost_;
      gap_at_ = come_;
    }
    lost_ += count;
  }

  /// Time after the first scan, with the time of missing scans.
  /// \param position  may lie between two scans; not before the last gap but one.
  [[nodiscard]] double time_s(double position) const noexcept {
    const std::int64_t lost = position < static_cast<double>(gap_at_) ? lost_before_ : lost_;
    return (position + static_cast<double>(lost)) / scan_rate_Hz_;
  }

 private:
  double scan_rate_Hz_;
  std::int64_t come_ = 0;
  std::int64_t followed_ = 0;
  std::int64_t lost_ = 0;         ///< Before the scan that comes next.
  std::int64_t lost_before_ = 0;  ///< Before the last gap.
  std::int64_t gap_at_ = 0;       ///< Position of the first scan after the last gap.
};

}  // namespace stickslip::detect
