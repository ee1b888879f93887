#include "core/law/friction_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/analysis/grouping.hpp"
#include "core/base/contract.hpp"

namespace stickslip::law {
namespace {

/// A dependence is named beyond its interval of this confidence: two may be, so that one in fifty sets with
/// neither names one.
constexpr double kOutsideToName = 0.01;
/// And ruled out within this one.
constexpr double kOutsideToRuleOut = 0.05;
/// Part of S − K from which on a dependence matters, over a decade of speed about the middle of the tests.
constexpr double kPartThatMatters = 0.1;

using Scores = std::vector<double>;

using Group = std::vector<std::size_t>;

/// Indices of the tests of each speed. A group begins at its lowest speed: a chain of near speeds is not one.
std::vector<Group> groups_of(std::span<const LawTest> tests) {
  Group sorted(tests.size());
  std::iota(sorted.begin(), sorted.end(), std::size_t{0});
  std::stable_sort(sorted.begin(), sorted.end(), [tests](std::size_t one, std::size_t other) {
    return tests[one].pull_speed_m_per_s < tests[other].pull_speed_m_per_s;
  });
  std::vector<Group> groups;
  double highest = 0.0;
  for (const std::size_t test : sorted) {
    const double v = tests[test].pull_speed_m_per_s;
    if (groups.empty() || v > highest) {
      groups.emplace_back();
      highest = v * (1.0 + analysis::kSameSpeed);
    }
    groups.back().push_back(test);
  }
  return groups;
}

/// Mean over these tests, all of which have the value: of log₁₀ of the stick times for S, of the speeds for
/// K. A test whose S is higher by chance takes longer to reach it: its own stick time would find that chance
/// again as ageing.
double place_of(std::span<const LawTest> tests, const Group& group, bool ageing) {
  double sum = 0.0;
  for (const std::size_t test : group)
    sum += ageing ? std::log10(*tests[test].stick_time_s) : tests[test].pull_speed_m_per_s;
  return sum / static_cast<double>(group.size());
}

Dependence dependence_of(std::span<const LawTest> tests, std::optional<Value> LawTest::*value) {
  std::vector<double> places(tests.size());
  for (Group group : groups_of(tests)) {
    std::erase_if(group, [&](std::size_t test) { return !(tests[test].*value) || tests[test].held; });
    if (group.empty()) continue;
    const double place = place_of(tests, group, value == &LawTest::S);
    for (const std::size_t test : group) places[test] = place;
  }
  Dependence result;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const LawTest& test = tests[i];
    if (!(test.*value)) continue;
    if (test.held) places[i] = std::log10(*test.stick_time_s);
    result.points.push_back(
        {places[i], (test.*value)->value, (test.*value)->error, (test.*value)->systematic});
    result.tests.push_back(i);
  }
  result.constant = fit_line(result.points, false);
  result.line = fit_line(result.points, true);
  return result;
}

/// What a dependence is measured by, with the words for the part of it that matters.
struct Measure {
  double delta_mu = 0.0;  ///< 0: not known.
  const char* what_matters = "";
};

/// Mean of S − K over the tests that have both; a tenth of K where there is none.
Measure measure_of(std::span<const LawTest> tests) {
  double sum = 0.0;
  double count = 0.0;
  double K = 0.0;
  for (const LawTest& test : tests) {
    if (test.K) K = std::max(K, test.K->value);
    if (!test.S || !test.K) continue;
    sum += test.S->value - test.K->value;
    count += 1.0;
  }
  if (count > 0.0 && sum > 0.0) return {sum / count, "a tenth of S - K over a decade of speed"};
  return {0.1 * K, "a hundredth of K over a decade of speed"};
}

/// Speeds of a decade about the geometric middle of the tests, the slowest and the fastest.
std::array<double, 2> decade_of(std::span<const LawTest> tests) {
  double log_speed = 0.0;
  for (const LawTest& test : tests)
    log_speed += std::log10(test.pull_speed_m_per_s) / static_cast<double>(tests.size());
  return {std::pow(10.0, log_speed - 0.5), std::pow(10.0, log_speed + 0.5)};
}

/// Log density of each point by the line through the others; of a constant, where these have one place alone.
Scores scores_of(const Dependence& dependence, bool with_slope, std::size_t test_count) {
  Scores scores(test_count, 0.0);
  if (dependence.points.size() < kFewestTests) return scores;
  for (std::size_t i = 0; i < dependence.points.size(); ++i) {
    std::vector<Point> others = dependence.points;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    std::optional<Line> line = fit_line(others, with_slope);
    if (!line) line = fit_line(others, false);
    scores[dependence.tests[i]] = line->log_density(dependence.points[i]);
  }
  return scores;
}

/// Of the best less the law, over the tests.
LawScore compared(const Scores& law, const Scores& best) {
  const auto n = static_cast<double>(law.size());
  LawScore result;
  for (std::size_t i = 0; i < law.size(); ++i) {
    result.score += law[i] / n;
    result.behind += (best[i] - law[i]) / n;
  }
  double squares = 0.0;
  for (std::size_t i = 0; i < law.size(); ++i) squares += std::pow(best[i] - law[i] - result.behind, 2);
  result.behind_error = std::sqrt(squares / (n - 1.0) / n);
  return result;
}

int parameters_of(Law law) { return 2 + (has_ageing(law) ? 1 : 0) + (has_rate(law) ? 1 : 0); }

void choose(FrictionLaw& found, std::size_t test_count) {
  std::array<Scores, kLaws.size()> scores;
  std::array<double, kLaws.size()> sums{};
  for (std::size_t i = 0; i < kLaws.size(); ++i) {
    scores[i] = scores_of(found.ageing, has_ageing(kLaws[i]), test_count);
    const Scores of_K = scores_of(found.rate, has_rate(kLaws[i]), test_count);
    for (std::size_t test = 0; test < test_count; ++test) scores[i][test] += of_K[test];
    sums[i] = std::accumulate(scores[i].begin(), scores[i].end(), 0.0);
  }
  const auto best = static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
  std::array<LawScore, kLaws.size()> compared_scores;
  std::size_t chosen = best;
  for (std::size_t i = 0; i < kLaws.size(); ++i) {
    compared_scores[i] = compared(scores[i], scores[best]);
    if (compared_scores[i].behind > compared_scores[i].behind_error) continue;
    const int fewer = parameters_of(kLaws[chosen]) - parameters_of(kLaws[i]);
    if (fewer > 0 || (fewer == 0 && sums[i] > sums[chosen])) chosen = i;
  }
  found.scores = compared_scores;
  found.law = kLaws[chosen];
}

/// \param what  "S on the stick time". \param unknown  why what matters is not known, where it is not.
void judge(Dependence& own, bool chosen, const char* what, const char* what_matters, const char* unknown) {
  const auto cannot = [&own](std::string reason) {
    own.verdict = Verdict::kCannotTell;
    own.reason = std::move(reason);
  };
  if (own.points.size() < kFewestTests) {
    return cannot(fmt::format("{} value{} for {}, at least {} are needed", own.points.size(),
                              own.points.size() == 1 ? "" : "s", what, kFewestTests));
  }
  if (!own.line) return cannot(fmt::format("all tests for {} are at one speed", what));
  const Parameter& slope = *own.line->slope;
  const double error = std::sqrt(own.line->covariance(1, 1));
  const double size = std::abs(slope.value);
  if (chosen) {
    const double by_chance = two_sided_t(own.line->freedom, kOutsideToName) * error;
    if (size > by_chance + slope.systematic) {
      own.verdict = Verdict::kYes;
    } else if (size > by_chance && size <= slope.systematic) {
      own.systematic_vetoes = true;
      cannot(
          fmt::format("{} is seen, but its systematic part may have made it: more pulls do not help", what));
    } else {
      cannot(fmt::format("{} is seen, but chance or systematic parts may have made it", what));
    }
    return;
  }
  const double matters = own.slope_that_matters;
  if (!(matters > 0.0)) return cannot(fmt::format("{} is not seen, but {}", what, unknown));
  const double by_chance = two_sided_t(own.line->freedom, kOutsideToRuleOut) * error;
  const double highest = size + by_chance + slope.systematic;
  if (highest < matters) {
    own.verdict = Verdict::kNo;
    return;
  }
  own.systematic_vetoes = size + by_chance < matters && size + slope.systematic >= matters;
  cannot(fmt::format("{} is not seen, but may be {:.2g} times what matters ({}){}", what, highest / matters,
                     what_matters,
                     own.systematic_vetoes ? ", by its systematic part: more pulls do not help" : ""));
}

}  // namespace

std::string_view name(Law law) noexcept {
  constexpr std::array<std::string_view, kLaws.size()> kNames{"constant", "ageing", "rate",
                                                              "ageing-and-rate"};
  return kNames[static_cast<std::size_t>(law)];
}

std::string_view name(const FrictionLaw& found) noexcept {
  return found.is_rate_and_state() ? "rate-and-state" : name(found.law);
}

FrictionLaw find_law(std::span<const LawTest> tests) {
  STICKSLIP_EXPECTS(!tests.empty());
  FrictionLaw found;
  found.ageing = dependence_of(tests, &LawTest::S);
  found.rate = dependence_of(tests, &LawTest::K);
  const Measure measure = measure_of(tests);
  found.delta_mu = measure.delta_mu;
  const auto [slowest, fastest] = decade_of(tests);
  found.ageing.slope_that_matters = kPartThatMatters * found.delta_mu;  // The stick time is as 1/v.
  found.rate.slope_that_matters = kPartThatMatters * found.delta_mu / (fastest - slowest);
  if (std::max(found.ageing.points.size(), found.rate.points.size()) >= kFewestTests)
    choose(found, tests.size());
  const char* const unknown = found.rate.points.empty() ? "no test has K, so what matters is not known"
                                                        : "no K is above 0, so what matters is not known";
  judge(found.ageing, has_ageing(found.law), "S on the stick time", measure.what_matters, unknown);
  judge(found.rate, has_rate(found.law), "K on the speed", measure.what_matters, unknown);
  found.told = found.ageing.verdict != Verdict::kCannotTell && found.rate.verdict != Verdict::kCannotTell;
  found.rate_and_state = rate_and_state(tests, found.ageing.points, found.ageing.tests);
  if (found.is_rate_and_state()) {
    found.told = true;
    for (Dependence* own : {&found.ageing, &found.rate}) {
      own->verdict = Verdict::kYes;
      own->reason.clear();
    }
  } else if (found.told && found.rate_and_state && !found.rate_and_state->may_have_none) {
    found.told = false;
    found.ageing.verdict = Verdict::kCannotTell;
    found.ageing.reason =
        "S may depend on the pull speed as well as on the time at rest (rate-and-state friction): add a "
        "sheet "
        "with holds";
  }
  return found;
}

}  // namespace stickslip::law
