/// \file
/// A two-sided CUSUM chart of one quantity that needs no phase I and no known distribution.
///
///     ControlChart chart;
///     for (const double value : values)
///       if (const auto alarm = chart.add(value)) …
///
/// Each value becomes the normal score of its rank among the values before it,
/// z = Φ⁻¹((R − ½)/n) with the rank R of n values [McDonald, Naval Research Logistics 37:627–646, 1990].
/// Upper arm: max(0, · + z − k), lower arm: max(0, · − z − k); an arm above h is an alarm, and both restart
/// at 0 [Page 1954; Hawkins & Olwell 1998].
///
/// z − k is ln(Φ'(z − 2k)/Φ'(z))/2k: the log-likelihood ratio of a normal distribution whose mean is 2k
/// instead of 0. Equal values are one cell of that distribution, from the share a of values below them to the
/// share b up to them, and have the log-likelihood ratio of the cell, ln([Φ(Φ⁻¹(b) − 2k) − Φ(Φ⁻¹(a) − 2k)]/(b
/// − a))/2k [Steiner, Geyer & Wesolowsky, Technometrics 38:230–237, 1996]. False alarms then stay about as
/// rare as without ties, and a shift of a count that is mostly 0 is told nearly as soon as any chart can
/// (docs/evidence.md).
///
/// What is exact: while the values are independent draws from one continuous distribution, whichever, the
/// ranks are independent and uniform, and false alarms do not depend on the distribution. Below
/// kFullBaseline values that is all. What is not:
/// - From kFullBaseline values on, the values since an arm was 0 wait outside the baseline, so that a shift
///   does not become part of what it is compared with. That makes false alarms a little more frequent
///   (docs/trend.md, docs/evidence.md).
/// - Values that follow each other closely, as a drifting zero does, cause more alarms.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/signal/statistics.hpp"

namespace stickslip::trend {

/// k and h, in standard deviations.
inline constexpr double kReferenceValue = 0.5;
inline constexpr double kDecisionInterval = 7.0;
/// Shewhart limits, in standard deviations. They mark points and raise no alarm.
inline constexpr double kShewhart = 3.0;
/// Values from which on there are Shewhart limits [Montgomery 2012, 6.2: 20 to 25].
inline constexpr std::int64_t kFewestForLimits = 20;
/// Values from which on a shift of one standard deviation is told within 15 values on average (of rare counts
/// within twice as many), and values of an excursion wait outside the baseline. With fewer, waiting would
/// make false alarms too frequent.
inline constexpr std::int64_t kFullBaseline = 200;
/// Most values of the baseline; later ones are not taken into it. Its mean is then known to a hundredth of a
/// standard deviation, a fiftieth of k.
inline constexpr std::int64_t kLargestBaseline = 10'000;

/// Average number of values until the upper arm passes h, for independent normal scores whose mean is
/// `shift` standard deviations, negative for a fall: Siegmund's approximation [Siegmund, Sequential Analysis,
/// 1985; Montgomery 2012, eq. 9.5]. \param k, h  > 0.
[[nodiscard]] double one_sided_run_length(double shift, double k = kReferenceValue,
                                          double h = kDecisionInterval);
/// Average number of values until either arm passes h: 1/ARL = 1/ARL⁺ + 1/ARL⁻ of one_sided_run_length().
[[nodiscard]] double run_length(double shift, double k = kReferenceValue, double h = kDecisionInterval);

/// An arm has passed h. Indices count the values that were added, from 0.
struct ChartAlarm {
  bool rises = false;      ///< Which arm told it.
  std::int64_t onset = 0;  ///< Index of the first value after the arm was 0 last: the estimated change.
  std::int64_t told = 0;   ///< Index of the value that told it.
  double height = 0.0;     ///< Of that arm with this value: above kDecisionInterval.
  double shift = 0.0;      ///< Mean since the onset less that of all before, in the unit of the values.
  double standard_deviation = 0.0;  ///< Of the baseline at the onset.
};

/// The chart of one quantity, fed value by value.
class ControlChart {
 public:
  /// An alarm sets both arms to 0 and ends its excursion, whose values then join the baseline.
  /// \param value  finite (contract). \return an alarm if this value raises one.
  std::optional<ChartAlarm> add(double value);

  /// Sets both arms to 0; the baseline stays, and what waits outside joins it with the next value.
  void restart_arms();

  /// Values added.
  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  /// Height of an arm, in standard deviations; 0 after an alarm.
  [[nodiscard]] double upper() const noexcept { return upper_.height; }
  [[nodiscard]] double lower() const noexcept { return lower_.height; }
  /// Values since the arm that rose first was 0; 0 if both are. The onset of an alarm to come is one of these
  /// or a later value.
  [[nodiscard]] std::int64_t excursion_count() const noexcept {
    return static_cast<std::int64_t>(std::max(upper_.since.count, lower_.since.count));
  }
  /// Of the baseline; 0 without values.
  [[nodiscard]] double mean() const noexcept { return baseline_.mean; }
  /// Of the baseline; 0 with fewer than two values.
  [[nodiscard]] double standard_deviation() const noexcept { return std::sqrt(baseline_.variance()); }
  /// What a value adds to each arm, k taken off, by its rank among the baseline and itself.
  struct Scores {
    double rising = 0.0;
    double falling = 0.0;
  };
  [[nodiscard]] Scores scores(double value) const;
  /// Whether the latest value lies beyond the Shewhart limits of the baseline before it; false while that has
  /// fewer than kFewestForLimits values.
  [[nodiscard]] bool is_outside() const noexcept { return outside_; }

 private:
  struct Arm {
    double height = 0.0;
    signal::RunningMean since;        ///< Of the values since it was 0.
    double standard_deviation = 0.0;  ///< Of the baseline when it was 0 last.

    /// \param score  what the value adds. \param spread  standard deviation of the baseline now.
    /// \return true if it passes h.
    bool add(double score, double value, double spread);
  };
  /// The baseline takes what waits, but for the latest `left` values.
  void settle(std::int64_t left);

  std::int64_t count_ = 0;
  Arm upper_;
  Arm lower_;
  std::vector<double> sorted_;  ///< The baseline, rising.
  signal::RunningVariance baseline_;
  std::deque<double> waiting_;  ///< Values of the present excursion that are not in the baseline.
  signal::RunningMean all_;
  bool outside_ = false;
};

}  // namespace stickslip::trend
