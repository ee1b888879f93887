/// \file
/// Evidence, from the drops of a slip and of the next one, that the first was captured.
#pragma once

namespace stickslip::detect {

/// Stores the typical drop (force from peak to trough) of the slips that begin from sticking, and no scans.
/// Fixed size; never allocates.
class FallHeights {
 public:
  /// Memory of the typical drop, in slips.
  static constexpr double kMemory = 16.0;

  /// \param gamma_over_2omega  of the oscillation.
  /// \return drop that follows one of `drop` in a free oscillation, which decays.
  [[nodiscard]] static double freely_next(double drop, double gamma_over_2omega) noexcept;
  /// \param sigma  noise of a scan.
  /// \return whether `drop` exceeds `freely_next` by more than noise and sampling explain, so that the sled
  /// has stuck in between.
  [[nodiscard]] static bool is_more_than(double drop, double freely_next, double sigma) noexcept;

  /// Log-likelihood ratio, captured over free, from a drop and the next one.
  /// \param is_damping_known  the damping in freely_next() comes from a characterisation.
  [[nodiscard]] double evidence(double drop, double next_drop, double freely_next, bool is_damping_known,
                                double sigma) noexcept;
  /// Adds next_drop of the latest evidence() call to the typical drop: its slip began from sticking, since
  /// the one before it was captured.
  void learn() noexcept;

  /// Number of slips in usual_drop(), at most kMemory.
  [[nodiscard]] double count() const noexcept { return count_; }
  /// Typical drop of a slip that begins from sticking. \param otherwise  returned if none is known.
  [[nodiscard]] double usual_drop(double otherwise) const noexcept;

 private:
  double usual_log_drop_ = 0.0;
  double off_usual_ = 0.0;  ///< Of the last one asked about.
  double count_ = 0.0;
};

}  // namespace stickslip::detect
