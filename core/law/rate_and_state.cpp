#include "core/law/rate_and_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/LU>

#include "core/analysis/grouping.hpp"
#include "core/law/friction_law.hpp"
#include "core/model/tester.hpp"

namespace stickslip::law {
namespace {

/// The direct effect a is named beyond its interval of this confidence, and leaves the law open beyond the
/// other.
constexpr double kNamedOutside = 0.01;
constexpr double kRuledOutOutside = 0.05;

/// A pull is slow if the sled rests so many times longer than it slips.
constexpr double kSlowPull = 5.0;

/// K and S − K of a pull.
struct PullLevels {
  double K = 0.0;
  double delta_mu = 0.0;
};

std::optional<PullLevels> levels_of(const LawTest& test) {
  if (test.held || !test.S || !test.K || !(test.S->value > test.K->value)) return std::nullopt;
  return PullLevels{test.K->value, test.S->value - test.K->value};
}

/// Of the sheet's own pull, else of the pull whose speed is nearest; nullopt if none has S and K.
std::optional<PullLevels> usual_levels(std::span<const LawTest> tests, const LawTest& hold) {
  std::optional<PullLevels> usual;
  double least = 0.0;
  bool is_own = false;
  for (const LawTest& test : tests) {
    const auto levels = levels_of(test);
    const bool own = test.sheet == hold.sheet;
    if (!levels || (is_own && !own)) continue;
    const double off = std::abs(std::log(test.pull_speed_m_per_s / hold.pull_speed_m_per_s));
    if (usual && own == is_own && off >= least) continue;
    usual = levels;
    least = off;
    is_own = own;
  }
  return usual;
}

/// ω₀ of a pull, by t = 2 (S − K) g/(ω₀² v), rad/s.
double omega0_of(double delta_mu, double rest_s, double speed_m_per_s) {
  return std::sqrt(2.0 * delta_mu * model::kStandardGravity_m_per_s2 / (rest_s * speed_m_per_s));
}

bool is_slow(const LawTest& test) {
  const auto levels = levels_of(test);
  if (!levels) return false;
  const double slip_s =
      std::numbers::pi / omega0_of(levels->delta_mu, *test.stick_time_s, test.pull_speed_m_per_s);
  return *test.stick_time_s >= kSlowPull * slip_s;
}

/// By how much a slip of this S has a lower K than a usual one, as it is faster.
double K_drop_of(const PullLevels& usual, double S, double b_less_a) {
  const double ratio = (S - usual.K) / usual.delta_mu;
  return ratio > 0.0 ? b_less_a * std::log(ratio) : 0.0;
}

/// The pulls at their geometric mean.
struct MeanPull {
  double delta_mu = 0.0;
  double log_rest = 0.0;   ///< log₁₀ of s
  double log_speed = 0.0;  ///< log₁₀ of m/s
};

/// ln of D_c in metres, by the drop of the pulls.
double log_critical_slip(const MeanPull& pull, double a, double b) {
  // K is the mean over the way of a slip, whose speed is V sin: ln V is less by 1 − ln 2 on average.
  constexpr double kMeanOfLogarithm = 1.0 - std::numbers::ln2;
  const double rest_s = std::pow(10.0, pull.log_rest);
  const double v = std::pow(10.0, pull.log_speed);
  const double slip_speed =
      pull.delta_mu * model::kStandardGravity_m_per_s2 / omega0_of(pull.delta_mu, rest_s, v);
  const double drop = pull.delta_mu + kMeanOfLogarithm * (b - a);
  return std::log(slip_speed * rest_s) - (drop + a * std::log(slip_speed / v)) / b;
}

/// S of a test on a sheet with holds.
struct Place {
  Point S;  ///< x: log₁₀ of the stick time
  Eigen::Index sheet = 0;
  std::size_t test = 0;
};

/// S over log₁₀ t with one slope, and a level for each sheet.
struct SheetLines {
  Eigen::VectorXd value;  ///< The slope, then the levels.
  double slope_variance = 0.0;
  Leftover left;
};

SheetLines solve_sheets(std::span<const Place> places, Eigen::Index sheet_count, double between_variance) {
  const auto weight = [&](const Place& place) {
    return 1.0 / (place.S.error * place.S.error + between_variance);
  };
  const auto row = [&](const Place& place) {
    Eigen::VectorXd own = Eigen::VectorXd::Zero(1 + sheet_count);
    own[0] = place.S.x;
    own[1 + place.sheet] = 1.0;
    return own;
  };
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(1 + sheet_count, 1 + sheet_count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(1 + sheet_count);
  for (const Place& place : places) {
    information += weight(place) * row(place) * row(place).transpose();
    right += weight(place) * place.S.y * row(place);
  }
  const Eigen::MatrixXd covariance = information.inverse();
  SheetLines lines{covariance * right, covariance(0, 0), {}};
  for (const Place& place : places) {
    const double residual = place.S.y - lines.value.dot(row(place));
    lines.left.squares += residual * residual;
    lines.left.chi_squared += weight(place) * residual * residual;
  }
  return lines;
}

/// A slope over log₁₀ t, before Student's factor.
struct Slope {
  double value = 0.0;
  double variance = 0.0;
  double freedom = 0.0;
  double systematic = 0.0;

  /// Whether it exceeds its interval.
  [[nodiscard]] bool exceeds(double outside) const {
    return value > two_sided_t(freedom, outside) * std::sqrt(variance) + systematic;
  }
  /// Natural logarithms of both.
  [[nodiscard]] Parameter parameter() const {
    return {value / std::numbers::ln10, student_factor(freedom) * std::sqrt(variance) / std::numbers::ln10,
            systematic / std::numbers::ln10};
  }
};

/// Degrees of freedom of the difference of two independent slopes [Welch, Biometrika 34:28–35, 1947].
Slope difference(const Slope& one, const Slope& other) {
  const double variance = one.variance + other.variance;
  return {one.value - other.value, variance,
          variance * variance /
              (one.variance * one.variance / one.freedom + other.variance * other.variance / other.freedom),
          one.systematic + other.systematic};
}

Slope slope_of(const Line& line) {
  return {line.slope->value, line.covariance(1, 1), line.freedom, line.slope->systematic};
}

/// Of all sheets with holds.
struct SheetFit {
  SheetLines lines;
  Slope slope;
};

SheetFit fit_sheets(std::span<const Place> places, Eigen::Index sheet_count) {
  SheetFit fit;
  const double freedom = static_cast<double>(places.size()) - 1.0 - static_cast<double>(sheet_count);
  const double between = between_variance_of(
      [&](double variance) { return solve_sheets(places, sheet_count, variance).left; }, freedom);
  fit.lines = solve_sheets(places, sheet_count, between);
  std::vector<Place> moved{places.begin(), places.end()};
  for (Place& place : moved) place.S.y += place.S.systematic;
  const double slope = fit.lines.value[0];
  const double other = solve_sheets(moved, sheet_count, between).value[0];
  fit.slope = {slope, fit.lines.slope_variance, freedom, std::abs(other - slope)};
  return fit;
}

/// ln of the factor within which D_c is known. \param b_less_a  by the pulls.
double log_factor(const MeanPull& pull, const Slope& b, const Slope& b_less_a) {
  constexpr double kStep = 1e-6;
  const auto at = [&](double own_b, double own_b_less_a) {
    return log_critical_slip(pull, (own_b - own_b_less_a) / std::numbers::ln10, own_b / std::numbers::ln10);
  };
  const double here = at(b.value, b_less_a.value);
  const double by_b = (at(b.value + kStep, b_less_a.value) - here) / kStep;
  const double by_other = (at(b.value, b_less_a.value + kStep) - here) / kStep;
  return std::hypot(
      std::log(kCriticalSlipFactor), by_b * two_sided_t(b.freedom, kRuledOutOutside) * std::sqrt(b.variance),
      by_other * two_sided_t(b_less_a.freedom, kRuledOutOutside) * std::sqrt(b_less_a.variance));
}

}  // namespace

std::optional<RateAndState> rate_and_state(std::span<const LawTest> tests, std::span<const Point> points,
                                           std::span<const std::size_t> of_tests) {
  std::vector<std::size_t> sheets;  // With holds.
  for (const std::size_t test : of_tests) {
    if (tests[test].held && std::find(sheets.begin(), sheets.end(), tests[test].sheet) == sheets.end())
      sheets.push_back(tests[test].sheet);
  }
  std::vector<Place> places;
  std::vector<Point> pulls;
  std::vector<std::size_t> tests_of_pulls;
  MeanPull mean;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LawTest& test = tests[of_tests[i]];
    const auto sheet = std::find(sheets.begin(), sheets.end(), test.sheet);
    if (sheet != sheets.end()) {
      places.push_back({points[i], sheet - sheets.begin(), of_tests[i]});
    } else if (is_slow(test)) {
      pulls.push_back(points[i]);
      tests_of_pulls.push_back(of_tests[i]);
      mean.log_rest += points[i].x;
      mean.log_speed += std::log10(test.pull_speed_m_per_s);
      mean.delta_mu += levels_of(test)->delta_mu;
    }
  }
  const std::optional<Line> of_pulls = fit_line(pulls, true);
  if (sheets.empty() || !of_pulls || places.size() < sheets.size() + 2) return std::nullopt;
  for (double* sum : {&mean.log_rest, &mean.log_speed, &mean.delta_mu})
    *sum /= static_cast<double>(pulls.size());

  // Without a direct effect K would not depend on how fast the sled slips: asked before anything is
  // corrected, and once more at the end.
  const auto sheet_count = static_cast<Eigen::Index>(sheets.size());
  const Slope b_less_a = slope_of(*of_pulls);
  SheetFit fit = fit_sheets(places, sheet_count);
  const Slope uncorrected = difference(fit.slope, b_less_a);
  std::vector<double> K_drop(places.size(), 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LawTest& test = tests[places[i].test];
    if (test.held)
      K_drop[i] = K_drop_of(*usual_levels(tests, test), places[i].S.y, b_less_a.value / std::numbers::ln10);
    places[i].S.y -= K_drop[i];
  }
  fit = fit_sheets(places, sheet_count);
  const Slope direct = difference(fit.slope, b_less_a);

  RateAndState found;
  found.b = fit.slope.parameter();
  found.a = direct.parameter();
  found.a.systematic = std::hypot(found.a.systematic, kDirectEffectPart * found.a.value);
  found.critical_slip_m = std::exp(log_critical_slip(mean, found.a.value, found.b.value));
  found.within_factor = std::exp(log_factor(mean, fit.slope, b_less_a));
  found.is_told = uncorrected.exceeds(kNamedOutside) && direct.exceeds(kNamedOutside) &&
                  fit.slope.exceeds(kRuledOutOutside) && b_less_a.exceeds(kRuledOutOutside) &&
                  std::isfinite(found.critical_slip_m);
  found.may_have_none = !uncorrected.exceeds(kRuledOutOutside) || !direct.exceeds(kRuledOutOutside);
  found.between_variance = of_pulls->between_variance;
  found.S.resize(tests.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    found.S[places[i].test] =
        fit.lines.value[0] * places[i].S.x + fit.lines.value[1 + places[i].sheet] + K_drop[i];
  }
  for (std::size_t i = 0; i < pulls.size(); ++i)
    found.S[tests_of_pulls[i]] = of_pulls->predicted(pulls[i].x).value;
  return found;
}

}  // namespace stickslip::law
