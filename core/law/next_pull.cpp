#include "core/law/next_pull.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/analysis/grouping.hpp"

namespace stickslip::law {
namespace {

/// Speeds that are tried, evenly in their logarithms.
constexpr int kCandidates = 25;
/// A sled pulled near the threshold escapes by chance.
constexpr double kSafelySticking = 0.8;

/// log₁₀ of stick time times speed, which hardly depends on the speed: the same rise of the force.
double log_stick_length(std::span<const LawTest> tests) {
  double sum = 0.0;
  double count = 0.0;
  for (const LawTest& test : tests) {
    if (!test.S || test.held) continue;
    sum += std::log10(*test.stick_time_s * test.pull_speed_m_per_s);
    count += 1.0;
  }
  return sum / count;
}

/// Error of a test like these: the median.
double usual_error(const Dependence& dependence) {
  std::vector<double> errors;
  for (const Point& point : dependence.points) errors.push_back(point.error);
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

double between_variance(const Dependence& dependence) {
  if (dependence.line) return dependence.line->between_variance;
  return dependence.constant ? dependence.constant->between_variance : 0.0;
}

/// \param highest_m_per_s  of the pulls that tell it.
std::optional<NextPull> best_pull(const Dependence& asked, bool ageing, std::span<const LawTest> tests,
                                  const SpeedRange& range, double highest_m_per_s) {
  if (asked.verdict != Verdict::kCannotTell || asked.systematic_vetoes || asked.points.empty())
    return std::nullopt;
  const double length = ageing ? log_stick_length(tests) : 0.0;
  const auto place = [&](double v) {
    for (std::size_t i = 0; i < asked.points.size(); ++i) {
      const double had = tests[asked.tests[i]].pull_speed_m_per_s;
      if (!tests[asked.tests[i]].held && std::abs(v - had) <= analysis::kSameSpeed * std::max(v, had))
        return asked.points[i].x;
    }
    return ageing ? length - std::log10(v) : v;
  };
  std::vector<Point> points = asked.points;
  points.push_back({0.0, 0.0, usual_error(asked), 0.0});
  const double variance = between_variance(asked);
  NextPull best;
  best.tells_ageing = ageing;
  for (int i = 0; i < kCandidates && highest_m_per_s >= range.from_m_per_s; ++i) {
    const double part = static_cast<double>(i) / (kCandidates - 1);
    const double v = range.from_m_per_s * std::pow(highest_m_per_s / range.from_m_per_s, part);
    points.back().x = place(v);
    const double separation = asked.slope_that_matters / slope_error(points, variance);
    if (!(separation > best.separation)) continue;
    best.separation = separation;
    best.pull_speed_m_per_s = v;
  }
  const auto held = std::find_if(tests.begin(), tests.end(), [](const LawTest& test) { return test.held; });
  if (ageing && held != tests.end()) {
    points.back().x = std::log10(kLongestHold_s);
    const double separation = asked.slope_that_matters / slope_error(points, variance);
    if (separation > best.separation) best = {held->pull_speed_m_per_s, kLongestHold_s, true, separation};
  }
  return best.separation > 0.0 ? std::optional{best} : std::nullopt;
}

}  // namespace

SpeedRange usual_range(std::span<const LawTest> tests) {
  const auto [slowest, fastest] =
      std::minmax_element(tests.begin(), tests.end(), [](const LawTest& one, const LawTest& other) {
        return one.pull_speed_m_per_s < other.pull_speed_m_per_s;
      });
  return {slowest->pull_speed_m_per_s / 3.0, fastest->pull_speed_m_per_s * 3.0};
}

std::optional<NextPull> next_pull(const FrictionLaw& found, std::span<const LawTest> tests,
                                  const SpeedRange& range, std::optional<double> highest_sticking_m_per_s) {
  // More holds tell a, not another pull.
  if (found.rate_and_state && !found.rate_and_state->may_have_none) return std::nullopt;
  // S is asked first: a pull that tells it tells K, too.
  const double sticking = highest_sticking_m_per_s
                              ? std::min(range.to_m_per_s, kSafelySticking * *highest_sticking_m_per_s)
                              : range.to_m_per_s;
  if (const auto pull = best_pull(found.ageing, true, tests, range, sticking)) return pull;
  return best_pull(found.rate, false, tests, range, range.to_m_per_s);
}

}  // namespace stickslip::law
