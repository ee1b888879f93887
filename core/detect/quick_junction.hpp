/// \file
/// The question of core/detect/live_junction for the price of a few sums: was the slip captured or does it
/// go on freely, where the scans leave no doubt?
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "core/detect/live_junction.hpp"
#include "core/detect/quick_capture.hpp"
#include "core/detect/scan_rows.hpp"
#include "core/detect/slip_rows.hpp"

namespace stickslip::detect {

/// Both courses through rows at equal times. The free one is a matter of one elimination. The captured one is
/// fitted once for a slip or twice: in between, a row that comes only adds what the course leaves of it.
///
/// What it does not know: Huber's weights, a stick rate that is wrong, more than the begin of the next slip.
/// Where any of these could matter it says so, and LiveJunction has to be asked. Fixed size; never allocates.
class QuickJunction {
 public:
  enum class Answer {
    kDoubt,     ///< LiveJunction has to be asked.
    kNotYet,    ///< The scans so far decide nothing.
    kCaptured,  ///< They do, and evidence() says how.
    kFree,
  };

  /// \param scan_s  from scan to scan, > 0.
  explicit QuickJunction(double scan_s) noexcept : rows_(scan_s) {}

  /// The next scan. \param usable  it is no spike and not saturated.
  void add(double value, bool usable) noexcept { rows_.add(value, usable); }
  /// Scans are missing.
  void gap() noexcept;
  /// A slip begins. \param omega  of its oscillation, rad/s: where the rows do not fit it, it gets none, and
  /// the next one has others.
  void fit_rows(double omega) noexcept;
  /// A slip whose scans from peak_s on belong to one course. \param now_s  time of the last scan.
  /// \param level  about its middle.
  void open(double now_s, double peak_s, double level, const model::SharedParameters& shared) noexcept;
  /// \param sigma  noise of one scan. \param typical_delta_mu,decisive  as in LiveJunction; decisive > 0.
  /// \param until_s  by what came before then; not earlier than the last time for a slip.
  [[nodiscard]] Answer ask(double sigma, double typical_delta_mu, double decisive,
                           double until_s = std::numeric_limits<double>::infinity()) noexcept;
  /// Of the last answer that decided.
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
  /// \param scale  1/σ² of a row, or less where neither course fits. \return if that is decisive, perhaps
  /// less than the whole.
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
