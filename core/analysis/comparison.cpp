#include "core/analysis/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/hypergeometric.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/math/tools/roots.hpp>

namespace stickslip::analysis {
namespace {

double upper_t(double degrees_of_freedom) {
  return boost::math::quantile(
      boost::math::complement(boost::math::students_t{degrees_of_freedom}, kSignificance / 2.0));
}

MeanWithError mean_of(const Replicates& tests) {
  const auto n = static_cast<double>(tests.count);
  return {tests.mean, *tests.standard_deviation / std::sqrt(n), n};
}

/// The noncentrality at which the noncentral t with these degrees of freedom falls below `t` with this
/// probability.
/// \throws std::runtime_error where there is no answer in double.
double noncentrality(double t, double degrees_of_freedom, double probability) {
  const auto excess = [&](double centre) {
    return boost::math::cdf(boost::math::non_central_t{degrees_of_freedom, centre}, t) - probability;
  };
  // About the standard deviation of t; doubled until the root is between: the probability falls with the
  // centre.
  double width = std::sqrt(1.0 + t * t / (2.0 * degrees_of_freedom));
  double low = t - width;
  double high = t + width;
  constexpr int kMostDoublings = 20;
  for (int i = 0; i < kMostDoublings && !(excess(low) > 0.0); ++i) low -= (width *= 2.0);
  for (int i = 0; i < kMostDoublings && !(excess(high) < 0.0); ++i) high += (width *= 2.0);
  constexpr int kBits = 40;  // Twelve digits, enough for a confidence interval.
  std::uintmax_t most_steps = 200;
  const auto [below, above] = boost::math::tools::toms748_solve(
      excess, low, high, boost::math::tools::eps_tolerance<double>{kBits}, most_steps);
  return 0.5 * (below + above);
}

EffectSize effect_size(const Replicates& a, const Replicates& b) {
  const double n_a = static_cast<double>(a.count);
  const double n_b = static_cast<double>(b.count);
  const double degrees = n_a + n_b - 2.0;
  const Replicates both[] = {a, b};
  const double d = (a.mean - b.mean) / *pooled_standard_deviation(both);
  // J(ν) = Γ(ν/2)/(√(ν/2) Γ((ν − 1)/2)) [Hedges 1981, (6e)].
  const double correction =
      1.0 / (boost::math::tgamma_delta_ratio((degrees - 1.0) / 2.0, 0.5) * std::sqrt(degrees / 2.0));
  const double per_t = std::sqrt(1.0 / n_a + 1.0 / n_b);
  EffectSize result;
  result.g = correction * d;
  try {
    const double t = d / per_t;
    result.interval = Interval{correction * per_t * noncentrality(t, degrees, 1.0 - kSignificance / 2.0),
                               correction * per_t * noncentrality(t, degrees, kSignificance / 2.0)};
  } catch (const std::exception&) {  // Boost.Math: no convergence, or no change of sign.
    result.interval.reset();
  }
  return result;
}

}  // namespace

Welch welch(const MeanWithError& a, const MeanWithError& b) {
  const double variance_a = a.standard_error * a.standard_error;
  const double variance_b = b.standard_error * b.standard_error;
  const double variance = variance_a + variance_b;
  Welch result;
  result.difference = a.mean - b.mean;
  result.degrees_of_freedom =
      variance * variance /
      (variance_a * variance_a / (a.count - 1.0) + variance_b * variance_b / (b.count - 1.0));
  const double error = std::sqrt(variance);
  result.t = result.difference / error;
  const double half = upper_t(result.degrees_of_freedom) * error;
  result.interval = {result.difference - half, result.difference + half};
  const boost::math::students_t distribution{result.degrees_of_freedom};
  result.p = 2.0 * boost::math::cdf(boost::math::complement(distribution, std::abs(result.t)));
  return result;
}

double power_of_t_test(double effect, int count) {
  const double n = count;
  const double degrees = 2.0 * n - 2.0;
  const double limit = upper_t(degrees);
  const boost::math::non_central_t distribution{degrees, effect * std::sqrt(n / 2.0)};
  return boost::math::cdf(boost::math::complement(distribution, limit)) +
         boost::math::cdf(distribution, -limit);
}

std::optional<int> tests_needed(double effect, double power) {
  const auto reaches = [&](int count) { return power_of_t_test(effect, count) >= power; };
  int too_few = 1;
  int enough = 2;
  while (!reaches(enough)) {
    if (enough >= kMostTestsNeeded) return std::nullopt;
    too_few = enough;
    enough = std::min(2 * enough, kMostTestsNeeded);
  }
  while (enough - too_few > 1) {
    const int middle = too_few + (enough - too_few) / 2;
    (reaches(middle) ? enough : too_few) = middle;
  }
  return enough;
}

double exact_p(unsigned a_yes, unsigned a_no, unsigned b_yes, unsigned b_no) {
  const unsigned yes = a_yes + b_yes;
  const unsigned of_a = a_yes + a_no;
  const unsigned all = of_a + b_yes + b_no;
  if (of_a == 0 || of_a == all || yes == 0 || yes == all) return 1.0;
  const boost::math::hypergeometric distribution{yes, of_a, all};
  // Tables as likely as this one count, whatever rounding did to them; SciPy and R do the same.
  constexpr double kRounding = 1e-7;
  const double limit = boost::math::pdf(distribution, a_yes) * (1.0 + kRounding);
  const unsigned least = yes + of_a > all ? yes + of_a - all : 0;
  double p = 0.0;
  for (unsigned k = least; k <= std::min(yes, of_a); ++k) {
    const double probability = boost::math::pdf(distribution, k);
    if (probability <= limit) p += probability;
  }
  return std::min(p, 1.0);
}

double combined_p(std::span<const double> p) {
  double statistic = 0.0;
  for (const double each : p) {
    if (each == 0.0) return 0.0;
    statistic -= 2.0 * std::log(each);
  }
  const boost::math::chi_squared distribution{2.0 * static_cast<double>(p.size())};
  return boost::math::cdf(boost::math::complement(distribution, statistic));
}

Comparison compare(const Replicates& a, const Replicates& b) {
  Comparison result;
  if (!a.standard_deviation || !b.standard_deviation) {
    result.reason = "two values of each are needed to know the scatter";
    return result;
  }
  const Replicates both[] = {a, b};
  if (!(*pooled_standard_deviation(both) > 0.0)) {
    result.reason = "the values do not scatter";
    return result;
  }
  result.welch = welch(mean_of(a), mean_of(b));
  result.effect = effect_size(a, b);
  // Effect beyond which two tests of each material have a power of 0.99999.
  constexpr double kLargestEffect = 25.0;
  const double effect = std::min(std::abs(result.effect->g), kLargestEffect);
  result.needed = TestsNeeded{tests_needed(effect, 0.8), tests_needed(effect, 0.9)};
  return result;
}

}  // namespace stickslip::analysis
