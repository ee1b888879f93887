#include "core/analysis/pooled.hpp"

#include <utility>

#include <boost/math/distributions/students_t.hpp>

namespace stickslip::analysis {

std::optional<Interval> mean_interval(const PooledDeltaMu& pooled) {
  const Estimate& mean = pooled.mean;
  if (!mean.value || !mean.standard_error || pooled.test_count < 2) return std::nullopt;
  const boost::math::students_t distribution{static_cast<double>(pooled.test_count) - 1.0};
  const double half = *mean.standard_error *
                      boost::math::quantile(boost::math::complement(distribution, kSignificance / 2.0));
  return Interval{*mean.value - half, *mean.value + half};
}

PooledComparison compare_pooled(const PooledDeltaMu& a, const PooledDeltaMu& b) {
  for (const auto& [side, pooled] : {std::pair{"A", &a}, std::pair{"B", &b}}) {
    if (!pooled->mean.value) return {{}, std::string{"in "} + side + " " + pooled->mean.reason};
    if (!pooled->mean.standard_error) {
      return {{}, std::string{"one test of "} + side + " has such slips; two are needed"};
    }
  }
  const MeanWithError of_a{*a.mean.value, *a.mean.standard_error, static_cast<double>(a.test_count)};
  const MeanWithError of_b{*b.mean.value, *b.mean.standard_error, static_cast<double>(b.test_count)};
  if (!(of_a.standard_error > 0.0 || of_b.standard_error > 0.0)) return {{}, "the tests do not scatter"};
  return {welch(of_a, of_b), {}};
}

}  // namespace stickslip::analysis
