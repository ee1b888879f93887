/// \file
/// Comparison of two materials: significance and size of the difference, and the number of tests needed to
/// detect it.
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

/// Mean of several tests: input of welch().
struct MeanWithError {
  double mean = 0.0;
  double standard_error = 0.0;
  double count = 0.0;  ///< Of tests, ≥ 2.
};

/// Welch's test of mean A against mean B.
/// \param a,b  at least one with a standard error > 0.
[[nodiscard]] Welch welch(const MeanWithError& a, const MeanWithError& b);

/// The difference in units of the scatter of single tests, without the bias of small samples
/// [Hedges 1981, J. Educ. Stat. 6, 107].
struct EffectSize {
  double g = 0.0;  ///< J(ν) (mean A − mean B)/s_pooled; J: Hedges' correction, ν = n_A + n_B − 2.
  std::optional<Interval>
      interval;  ///< 95 %, by inverting the noncentral t [Cumming & Finch 2001,
                 ///< Educ. Psychol. Meas. 61, 532]; none where that has no answer in double.
};

/// Number of tests of each material with which Student's t test (two-sided, 5 %) detects a difference as
/// large as the one found, with the stated power [Cohen 1988, Statistical Power Analysis, 2.4; noncentral t
/// by Boost.Math].
struct TestsNeeded {
  std::optional<int> for_80_percent;  ///< Nullopt: more than kMostTestsNeeded.
  std::optional<int> for_90_percent;
};

inline constexpr int kMostTestsNeeded = 10'000;

/// All statistics of compare().
struct Comparison {
  std::optional<Welch> welch;
  std::optional<EffectSize> effect;
  std::optional<TestsNeeded> needed;
  std::string reason;  ///< Why the other members are empty; set exactly then.
};

/// Compares two materials by their single tests. Needs two values of each, and scatter in at least one;
/// otherwise only `reason` is set.
[[nodiscard]] Comparison compare(const Replicates& a, const Replicates& b);

/// Probability that Student's t test with `count` tests of each material, two-sided at 5 %, finds a
/// difference of `effect` standard deviations.
/// \param effect  ≥ 0.
/// \param count  ≥ 2.
[[nodiscard]] double power_of_t_test(double effect, int count);

/// Smallest number of tests of each material, ≥ 2, with which power_of_t_test() reaches `power`; nullopt if
/// that takes more than kMostTestsNeeded.
/// \param effect  ≥ 0, in standard deviations.
/// \param power  in (0, 1).
[[nodiscard]] std::optional<int> tests_needed(double effect, double power);

/// Fisher's exact test of a 2 × 2 table: do A and B have equal shares of tests with a property, such as
/// sticking? Two-sided p: of all tables with the same sums of rows and columns, the summed probability of
/// those that are no more probable than this one, if A and B do not differ [Fisher 1935, J. R. Stat. Soc. 98,
/// 39; hypergeometric distribution by Boost.Math].
/// \param a_yes,a_no,b_yes,b_no  ≥ 0.
/// \return  p; 1 if a row or a column of the table is empty.
[[nodiscard]] double exact_p(unsigned a_yes, unsigned a_no, unsigned b_yes, unsigned b_no);

/// Fisher's combined p of k independent tests of no difference: −2 Σ ln p is χ² with 2k degrees of freedom
/// [Fisher 1932, Statistical Methods for Research Workers, 21.1].
/// \param p  at least one, in [0, 1].
[[nodiscard]] double combined_p(std::span<const double> p);

}  // namespace stickslip::analysis
