/// \file
/// Fast path of core/detect/live_junction: decides from running sums whether a slip was captured, and returns
/// kDoubt when LiveJunction is needed.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "core/detect/live_junction.hpp"
#include "core/detect/quick_capture.hpp"
#include "core/detect/scan_rows.hpp"
#include "core/detect/slip_rows.hpp"

namespace stickslip::detect {

/// Compares both trajectories on rows at equal times. The free one needs one elimination. The captured one is
/// fitted once or twice for a slip; in between, a new row only adds its residual to the cost.
///
/// It has no Huber weights, no error of the stick rate, and only the beginning of the next slip. If one of
/// these could matter it returns kDoubt. Fixed size; never allocates.
class QuickJunction {
 public:
  enum class Answer {
    kDoubt,     ///< LiveJunction must decide.
    kNotYet,    ///< The scans so far do not decide.
    kCaptured,  ///< Decided; evidence() holds the result.
    kFree,
  };

  /// \param scan_s  from scan to scan, > 0.
  explicit QuickJunction(double scan_s) noexcept : rows_(scan_s) {}

  /// The next scan. \param usable  it is no spike and not saturated.
  void add(double value, bool usable) noexcept { rows_.add(value, usable); }
  /// Scans are missing.
  void gap() noexcept;
  /// Adapts the length of the rows when a slip begins. If it does not suit this slip's ω, the slip has no
  /// rows, and the next one gets rows of another length.
  /// \param omega  of its oscillation, rad/s.
  void fit_rows(double omega) noexcept;
  /// Begins a slip whose scans from peak_s on are connected. \param now_s  time of the last scan.
  /// \param level  about its middle.
  void open(double now_s, double peak_s, double level, const model::SharedParameters& shared) noexcept;
  /// \param sigma  noise of one scan. \param typical_delta_mu,decisive  as in LiveJunction; decisive > 0.
  /// \param until_s  uses only rows before this time; must not decrease during a slip.
  [[nodiscard]] Answer ask(double sigma, double typical_delta_mu, double decisive,
                           double until_s = std::numeric_limits<double>::infinity()) noexcept;
  /// Evidence of the last decisive answer.
  [[nodiscard]] const JunctionEvidence& evidence() const noexcept { return evidence_; }
  [[nodiscard]] const ScanRows& rows() const noexcept { return rows_; }

 private:
  /// What the free course of all rows costs.
  struct Free {
    RowCourse course;
    double cost = 0.0;
  };

  /// \return what is to be said where no captured course can be fitted; nothing if one was.
  [[nodiscard]] std::optional<Answer> fit_capture(const Free& free, double decisive) noexcept;
  /// Where the free course does not reach the stick rate.
  [[nodiscard]] Answer ask_escaped(const Free& free, double decisive) noexcept;
  /// To captured_cost_, what the course leaves of rows that have come.
  void add_new_rows() noexcept;
  /// Fits the course again where that could decide. \return whether it is still a captured one.
  [[nodiscard]] bool improve(const Free& free, double decisive) noexcept;
  [[nodiscard]] bool has_stray(const RowCourse& free) const noexcept;
  /// Captured over free, where a stray tells no more than one scan can: not more than the full question says.
  /// \param scale  1/σ² of a row, or less where neither course fits.
  /// \return if that is decisive, perhaps less than the whole.
  [[nodiscard]] double told(const RowCourse& free_course, double scale, double decisive) const noexcept;

  ScanRows rows_;
  // The slip under way.
  bool open_ = false;
  SlipRows slip_;
  double row_variance_ = 0.0;
  double typical_delta_mu_ = 0.0;
  bool fitted_ = false;
  QuickCapture captured_;
  std::size_t captured_size_ = 0;  ///< Rows in captured_cost_,
  double captured_cost_ = 0.0;     ///< which is what captured_ costs for all of them,
  std::size_t fitted_size_ = 0;    ///< and those it was fitted to.
  JunctionEvidence evidence_;
};

}  // namespace stickslip::detect
