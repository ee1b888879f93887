/// \file
/// What does the cell read with no load on it? The level of quiet scans, for deciding where tests begin and
/// end.
///
///     UnloadedLevel level{rate_Hz, UnloadedLevel::kQuiet_s, step};
///     level.add(coefficient);
///     if (const auto quiet = level.news(); quiet && UnloadedLevel::fits(*quiet)) …
///
/// A force is quiet when its medians over the four quarters of a stretch differ by no more
/// than their noise explains, that noise is small, and nearly all scans lie within it. Pulling, ringing,
/// loading and unloading are not quiet. A quiet force may still be a load (a sled that slides steadily, a
/// belt that stopped): whether it is the unloaded cell is decided by who asks, with fits().
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace stickslip::pipeline {

/// Coefficients are force over normal load. Deterministic; thread-bound; add() does not allocate.
class UnloadedLevel {
 public:
  /// No quiet force farther from the calibrated zero is taken for the unloaded cell: friction of paper is
  /// higher.
  static constexpr double kFarthest = 0.1;
  /// A level so near is the calibrated zero: that of the self-check's finding (self_check.cpp), a tenth of
  /// the smallest S − K of Penner's Table 1. So a tester whose zero is right decides with zero itself.
  static constexpr double kNearest = 0.0025;
  /// After a load: only below this part of the largest force, above the level before, is a quiet force
  /// unloaded. A belt that stopped, and a sled that slides, hold more.
  static constexpr double kUnloadedPart = 1.0 / 3.0;
  /// Twice what the self-check complains of: what scatters more may hide a motion.
  static constexpr double kLargestNoise = 0.01;
  /// Shortest stretch that tells a level before a test, or ends one.
  static constexpr double kQuiet_s = 0.5;

  /// \param scan_rate_Hz  > 0. \param stretch_s  that is to be quiet; at least eight scans.
  /// \param step_coefficient  one A/D step; 0 if unknown.
  UnloadedLevel(double scan_rate_Hz, double stretch_s, double step_coefficient);

  /// Consecutive scans.
  void add(double coefficient);
  /// The scans so far are no part of a stretch to come: after a gap, or where a record begins.
  void clear() noexcept;

  /// The level of the stretch that has just become complete or longer, if it was quiet; else nothing. Only in
  /// the scan that completes a quarter of a stretch.
  [[nodiscard]] std::optional<double> news() const noexcept { return news_; }
  [[nodiscard]] std::size_t stretch_scans() const noexcept { return kQuarters * quarter_.size(); }
  /// The latest complete stretch was quiet.
  [[nodiscard]] bool quiet() const noexcept { return quiet_; }

  /// A quiet force at `level` may be the unloaded cell.
  /// \param largest  highest force of the test that it comes after. \param before  the level before that
  /// test.
  [[nodiscard]] static bool fits(double level) noexcept;
  [[nodiscard]] static bool fits_after(double level, double largest, double before) noexcept;
  /// \return 0 for a level so near to it that it is the calibrated zero.
  [[nodiscard]] static double of_decisions(double level) noexcept;

 private:
  static constexpr std::size_t kQuarters = 4;

  void close_quarter();

  double smallest_spread_;
  std::vector<double> quarter_;
  std::size_t filled_ = 0;
  std::array<double, kQuarters> medians_{};
  std::array<double, kQuarters> errors_{};           ///< Standard errors of the medians.
  std::array<std::ptrdiff_t, kQuarters> outside_{};  ///< Scans outside the band of the noise.
  std::size_t closed_ = 0;
  bool quiet_ = false;
  std::optional<double> news_;
};

}  // namespace stickslip::pipeline
