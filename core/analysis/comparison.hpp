/// \file
/// Do two materials differ, by how much, and how many tests would have shown it?
///
///     const Comparison found = compare(describe_replicates(a), describe_replicates(b));
///     if (found.welch && found.welch->p < kSignificance) …
#pragma once

#include <optional>
#include <span>
#include <string>

#include "core/analysis/replicates.hpp"

namespace stickslip::analysis {

/// Difference of means without the assumption of equal scatter [Welch 1947, Biometrika 34, 28].
struct Welch {
  double difference = 0.0;  ///< Mean of A − mean of B.
  Interval interval;        ///< 95 %, of the difference.
  double t = 0.0;
  double degrees_of_freedom = 0.0;  ///< Welch–Satterthwaite.
  double p = 0.0;                   ///< Two-sided.
};

/// A mean of several tests as Welch's test takes it.
struct MeanWithError {
  double mean = 0.0;
  double standard_error = 0.0;
  double count = 0.0;  ///< Of tests, ≥ 2.
};

/// \param a,b  not both without error.
[[nodiscard]] Welch welch(const MeanWithError& a, const MeanWithError& b);

/// The difference in units of the scatter of single tests, without the bias of small samples
/// [Hedges 1981, J. Educ. Stat. 6, 107].
struct EffectSize {
  double g = 0.0;  ///< J(ν) (mean A − mean B)/s_pooled.
  std::optional<Interval>
      interval;  ///< 95 %, by inverting the noncentral t [Cumming & Finch 2001,
                 ///< Educ. Psychol. Meas. 61, 532]; none where that has no answer in double.
};

/// Tests of each material with which Student's t test (two-sided, 5 %) finds a difference as large as the one
/// seen, with this probability [Cohen 1988, Statistical Power Analysis, 2.4; noncentral t by Boost.Math].
struct TestsNeeded {
  std::optional<int> for_80_percent;  ///< None: more than kMostTestsNeeded.
  std::optional<int> for_90_percent;
};

inline constexpr int kMostTestsNeeded = 10'000;

struct Comparison {
  std::optional<Welch> welch;
  std::optional<EffectSize> effect;
  std::optional<TestsNeeded> needed;
  std::string reason;  ///< Why nothing of this is known; set exactly then.
};

/// Needs two values of each, and some scatter.
[[nodiscard]] Comparison compare(const Replicates& a, const Replicates& b);

/// Probability that Student's t test with `count` tests of each material, two-sided at 5 %, finds a
/// difference of `effect` standard deviations. \param effect  ≥ 0. \param count  ≥ 2.
[[nodiscard]] double power_of_t_test(double effect, int count);

/// The least count that reaches the power; none above kMostTestsNeeded. \param power  in (0, 1).
[[nodiscard]] std::optional<int> tests_needed(double effect, double power);

/// Of so many tests of A and B some are of one kind (such as: sticking) and the others not. Probability of a
/// table as unlikely as this one, or more so, if A and B do not differ: two-sided, by the sum of all that are
/// no likelier [Fisher 1935, J. R. Stat. Soc. 98, 39; hypergeometric distribution by Boost.Math]. \param
/// a_yes,a_no,b_yes,b_no  ≥ 0. \return  1 where one of the materials or kinds is empty.
[[nodiscard]] double exact_p(unsigned a_yes, unsigned a_no, unsigned b_yes, unsigned b_no);

/// Several independent tests of "no difference" as one: −2 Σ ln p is χ² with 2k degrees of freedom
/// [Fisher 1932, Statistical Methods for Research Workers, 21.1]. \param p  at least one, in [0, 1].
[[nodiscard]] double combined_p(std::span<const double> p);

}  // namespace stickslip::analysis
