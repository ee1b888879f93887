/// \file
/// Level of the unloaded load cell, from quiet scans; the segmenter's thresholds are relative to it.
///
///     UnloadedLevel level{rate_Hz, UnloadedLevel::kQuiet_s, step};
///     level.add(coefficient);
///     if (const auto quiet = level.news(); quiet && UnloadedLevel::fits(*quiet)) …
///
/// A force is quiet when its medians over the four quarters of a stretch differ by no more
/// than their noise explains, that noise is small, and nearly all scans lie within it. Pulling, ringing,
/// loading and unloading are not quiet. A quiet force may still be a load (a sled that slides steadily, a
/// belt that stopped): the caller decides with fits() whether it is the unloaded cell.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace stickslip::pipeline {

/// Finds the level of the unloaded cell. Coefficients are force over normal load. Deterministic;
/// thread-bound; add() does not allocate.
class UnloadedLevel {
 public:
  /// Largest distance of the unloaded level from the calibrated zero; the friction of paper is higher.
  static constexpr double kFarthest = 0.1;
  /// Largest distance at which the level is taken to equal the calibrated zero, so that a correctly tared
  /// tester uses exactly 0. The self-check's limit (self_check.cpp), a tenth of the smallest S − K of
  /// Penner's Table 1.
  static constexpr double kNearest = 0.0025;
  /// After a load a quiet force counts as unloaded only up to this part of the largest force, both measured
  /// from the level before the load. A stopped belt and a sliding sled hold more.
  static constexpr double kUnloadedPart = 1.0 / 3.0;
  /// Largest noise (σ) of a quiet stretch, twice the self-check's limit; larger noise may hide a motion.
  static constexpr double kLargestNoise = 0.01;
  /// Shortest quiet stretch that gives a level before a test, or ends a test.
  static constexpr double kQuiet_s = 0.5;

  /// \param scan_rate_Hz  > 0.
  /// \param stretch_s  length of a stretch; taken as four quarters of 2 … 10⁶ whole scans each.
  /// \param step_coefficient  one A/D step; 0 if unknown.
  UnloadedLevel(double scan_rate_Hz, double stretch_s, double step_coefficient);

  /// Takes the next scan; scans are consecutive.
  void add(double coefficient);
  /// Starts a new stretch, after a gap or at the beginning of a record.
  void clear() noexcept;

  /// Level of the latest stretch, the mean of its quarters' medians, if the latest scan has completed a
  /// quarter and the stretch is quiet; else nullopt.
  [[nodiscard]] std::optional<double> news() const noexcept { return news_; }
  [[nodiscard]] std::size_t stretch_scans() const noexcept { return kQuarters * quarter_.size(); }
  /// Whether the latest complete stretch was quiet.
  [[nodiscard]] bool quiet() const noexcept { return quiet_; }

  /// Whether a quiet force at `level` may be that of the unloaded cell: at most kFarthest from zero.
  [[nodiscard]] static bool fits(double level) noexcept;
  /// fits() for a force during or after a test: also at most kUnloadedPart of the largest force.
  /// \param largest  highest coefficient of that test. \param before  the unloaded level before it.
  [[nodiscard]] static bool fits_after(double level, double largest, double before) noexcept;
  /// The level used for decisions: 0 if `level` is at most kNearest from it, else `level`.
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
