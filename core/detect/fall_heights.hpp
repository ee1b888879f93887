/// \file
/// How a slip ended, by the heights of its fall and of the next one alone.
#pragma once

namespace stickslip::detect {

/// Knows what the falls of a test are usually like, and keeps no scans. Fixed size; never allocates.
class FallHeights {
 public:
  /// Slips that count for what is usual.
  static constexpr double kMemory = 16.0;

  /// \param gamma_over_2omega  of the oscillation. \return the fall after one of `drop` if nothing sticks in
  /// between: a free oscillation only shrinks.
  [[nodiscard]] static double freely_next(double drop, double gamma_over_2omega) noexcept;
  /// \param sigma  noise of a scan. \return whether that is more than noise, and what is missed between
  /// scans, make of `freely_next`: something stuck in between.
  [[nodiscard]] static bool is_more_than(double drop, double freely_next, double sigma) noexcept;

  /// Of a fall and the one after it.
  /// \param is_damping_known  somebody has measured what freely_next() rests on.
  /// \return ln of the likelihood ratio, captured over free.
  [[nodiscard]] double evidence(double drop, double next_drop, double freely_next, bool is_damping_known,
                                double sigma) noexcept;
  /// The slip that evidence() was asked about last was captured.
  void learn() noexcept;

  /// Slips behind usual_drop(), kMemory at most.
  [[nodiscard]] double count() const noexcept { return count_; }
  /// Of a slip from sticking. \param otherwise  where none is known.
  [[nodiscard]] double usual_drop(double otherwise) const noexcept;

 private:
  double usual_log_drop_ = 0.0;
  double off_usual_ = 0.0;  ///< Of the last one asked about.
  double count_ = 0.0;
};

}  // namespace stickslip::detect
