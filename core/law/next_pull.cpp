#include "core/law/next_pull.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

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
    if (!test.S) continue;
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
  if (found.told) return std::nullopt;
  // S is asked first: a pull that tells it tells K, too.
  const bool ageing = found.ageing.verdict == Verdict::kCannotTell && !found.ageing.points.empty();
  const Dependence& asked = ageing ? found.ageing : found.rate;
  if (asked.points.empty()) return std::nullopt;
  const double fastest = ageing && highest_sticking_m_per_s
                             ? std::min(range.to_m_per_s, kSafelySticking * *highest_sticking_m_per_s)
                             : range.to_m_per_s;
  if (!(fastest >= range.from_m_per_s)) return std::nullopt;
  const double length = ageing ? log_stick_length(tests) : 0.0;
  const auto place = [&](double v) { return ageing ? length - std::log10(v) : v; };
  std::vector<Point> points = asked.points;
  const std::size_t had = points.size();
  const double variance = between_variance(asked);
  const auto separation = [&](double v, int pulls) {
    points.resize(had);
    points.resize(had + static_cast<std::size_t>(pulls), {place(v), 0.0, usual_error(asked), 0.0});
    return asked.slope_that_matters / slope_error(points, variance);
  };
  NextPull best;
  best.tells_ageing = ageing;
  for (int i = 0; i < kCandidates; ++i) {
    const double part = static_cast<double>(i) / (kCandidates - 1);
    const double v = range.from_m_per_s * std::pow(fastest / range.from_m_per_s, part);
    if (const double there = separation(v, 1); there > best.separation) {
      best.separation = there;
      best.pull_speed_m_per_s = v;
    }
  }
  if (!(best.separation > 0.0)) return std::nullopt;
  for (int pulls = 1; pulls <= kMostPulls && !best.pulls_needed; ++pulls) {
    const double freedom = static_cast<double>(had) + pulls - 2.0;
    // A dependence that just matters is named, one that is absent ruled out.
    if (had + static_cast<std::size_t>(pulls) >= kFewestTests &&
        separation(best.pull_speed_m_per_s, pulls) > two_sided_t(freedom, 0.01))
      best.pulls_needed = pulls;
  }
  return best;
}

}  // namespace stickslip::law
