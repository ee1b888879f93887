#include "core/law/rate_and_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "core/analysis/grouping.hpp"
#include "core/law/friction_law.hpp"
#include "core/model/tester.hpp"

namespace stickslip::law {
namespace {

/// The direct effect is named beyond its interval of this confidence, and ruled out within the other.
constexpr double kNamedOutside = 0.01;
constexpr double kRuledOutOutside = 0.05;

/// What S, K and the drop of pulls are, at their geometric mean or at one speed.
struct PullLevels {
  double K = 0.0;
  double delta_mu = 0.0;
};

/// S and K of the pull whose speed is nearest; nullopt if none has both.
std::optional<PullLevels> pull_nearest(std::span<const LawTest> tests, double speed_m_per_s) {
  std::optional<PullLevels> nearest;
  double least = 0.0;
  for (const LawTest& test : tests) {
    if (test.held || !test.S || !test.K || !(test.S->value > test.K->value)) continue;
    const double off = std::abs(std::log(test.pull_speed_m_per_s / speed_m_per_s));
    if (nearest && off >= least) continue;
    least = off;
    nearest = PullLevels{test.K->value, test.S->value - test.K->value};
  }
  return nearest;
}

/// By how much a slip of this drop has a lower K than a usual one, as it is faster.
double faster_slip(const PullLevels& usual, double S, double b_less_a) {
  const double ratio = (S - usual.K) / usual.delta_mu;
  return ratio > 0.0 ? b_less_a * std::log(ratio) : 0.0;
}

/// The drop of the pulls at their geometric mean, solved for D_c. \param log_rest,log_speed  log₁₀ of s, m/s.
double critical_slip_m(double delta_mu, double log_rest, double log_speed, double a, double b) {
  // K is the mean over the way of a slip, whose speed is V sin: ln V is less by 1 − ln 2 on average.
  constexpr double kMeanOfLogarithm = 1.0 - std::numbers::ln2;
  const double rest_s = std::pow(10.0, log_rest);
  const double v = std::pow(10.0, log_speed);
  // t = 2 (S − K) g/(ω₀² v) tells ω₀, and so V = (S − K) g/ω₀.
  const double slip_speed = std::sqrt(0.5 * delta_mu * model::kStandardGravity_m_per_s2 * rest_s * v);
  const double drop = delta_mu + kMeanOfLogarithm * (b - a);
  return slip_speed * rest_s * std::exp(-(drop + a * std::log(slip_speed / v)) / b);
}

struct Place {
  Point S;  ///< x: log₁₀ of the stick time
  double log_speed = 0.0;
};

struct Plane {
  Eigen::Vector3d value;  ///< S at 1 s and 1 m/s, by log₁₀ t, by log₁₀ v
  Eigen::Matrix3d covariance;
  Leftover left;
};

/// About the weighted middle, for the sake of roundings.
Plane solve(std::span<const Place> places, double between_variance) {
  const auto weight = [&](const Place& place) {
    return 1.0 / (place.S.error * place.S.error + between_variance);
  };
  double weights = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Place& place : places) {
    weights += weight(place);
    middle += weight(place) * Eigen::Vector3d{0.0, place.S.x, place.log_speed};
  }
  middle /= weights;
  const auto row = [&](const Place& place) {
    return Eigen::Vector3d{1.0, place.S.x - middle[1], place.log_speed - middle[2]};
  };
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const Place& place : places) {
    information += weight(place) * row(place) * row(place).transpose();
    right += weight(place) * place.S.y * row(place);
  }
  Plane plane;
  plane.covariance = information.inverse();
  plane.value = plane.covariance * right;
  for (const Place& place : places) {
    const double residual = place.S.y - plane.value.dot(row(place));
    plane.left.squares += residual * residual;
    plane.left.chi_squared += weight(place) * residual * residual;
  }
  plane.value[0] -= plane.value.tail<2>().dot(middle.tail<2>());
  return plane;
}

/// By how much the parameters move if each S moves by its systematic part.
Eigen::Vector3d systematic_of(std::span<const Place> places, double between_variance, const Plane& plane) {
  std::vector<Place> moved{places.begin(), places.end()};
  for (Place& place : moved) place.S.y += place.S.systematic;
  return (solve(moved, between_variance).value - plane.value).cwiseAbs();
}

/// Whether the speeds of the pulls, or the stick times of slips at one of them, are too much alike for a
/// plane.
bool is_one_line(std::span<const Place> places, std::span<const std::size_t> holds) {
  if (holds.empty()) return true;
  const auto [slowest, fastest] = std::minmax_element(
      places.begin(), places.end(),
      [](const Place& one, const Place& other) { return one.log_speed < other.log_speed; });
  return fastest->log_speed - slowest->log_speed <= std::log10(1.0 + analysis::kSameSpeed);
}

}  // namespace

double RateAndState::static_coefficient(double log_rest, double log_speed) const noexcept {
  return S_at_1 + std::numbers::ln10 * (b.value * log_rest + a.value * log_speed);
}

std::optional<RateAndState> rate_and_state(std::span<const LawTest> tests, std::span<const Point> points,
                                           std::span<const std::size_t> of_tests) {
  constexpr std::size_t kFewestPoints = 5;  // Two degrees of freedom.
  std::vector<Place> places;
  std::vector<std::size_t> holds;
  double log_rest = 0.0;
  double log_speed = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const LawTest& test = tests[of_tests[i]];
    places.push_back({points[i], std::log10(test.pull_speed_m_per_s)});
    if (test.held) {
      holds.push_back(i);
    } else {
      log_rest += points[i].x;
      log_speed += places.back().log_speed;
    }
  }
  if (places.size() < kFewestPoints || is_one_line(places, holds)) return std::nullopt;
  const auto pull_count = static_cast<double>(places.size() - holds.size());
  log_rest /= pull_count;
  log_speed /= pull_count;
  const auto usual = pull_nearest(tests, std::pow(10.0, log_speed));
  if (!usual) return std::nullopt;

  RateAndState found;
  const double freedom = static_cast<double>(places.size()) - 3.0;
  std::vector<double> lower(places.size(), 0.0);  // K of the slips after holds.
  Plane plane;
  double variance = 0.0;
  constexpr int kRounds = 4;  // Each leaves a tenth of what the correction is off.
  for (int round = 0; round < kRounds; ++round) {
    variance = between_variance_of([&](double between) { return solve(places, between).left; }, freedom);
    plane = solve(places, variance);
    // Without a direct effect K would not depend on how fast the sled slips: asked before anything is
    // corrected.
    if (round == 0) {
      const double by_chance = std::sqrt(plane.covariance(2, 2));
      const double systematic = systematic_of(places, variance, plane)[2];
      const auto exceeds = [&](double outside) {
        return plane.value[2] > two_sided_t(freedom, outside) * by_chance + systematic;
      };
      found.has_direct_effect = exceeds(kNamedOutside);
      found.may_have_none = !exceeds(kRuledOutOutside);
    }
    const double b_less_a = (plane.value[1] - plane.value[2]) / std::numbers::ln10;
    for (const std::size_t i : holds) {
      const PullLevels own = *pull_nearest(tests, tests[of_tests[i]].pull_speed_m_per_s);
      lower[i] = faster_slip(own, points[i].y, b_less_a);
      places[i].S.y = points[i].y - lower[i];
    }
  }
  const Eigen::Vector3d systematic = systematic_of(places, variance, plane);
  const auto parameter = [&](Eigen::Index i) {
    const double error = std::sqrt(plane.covariance(i, i));
    return Parameter{plane.value[i] / std::numbers::ln10,
                     student_factor(freedom) * error / std::numbers::ln10,
                     systematic[i] / std::numbers::ln10};
  };
  found.S_at_1 = plane.value[0];
  found.b = parameter(1);
  found.a = parameter(2);
  found.a.systematic = std::hypot(found.a.systematic, kDirectEffectPart * found.a.value);
  found.has_direct_effect = found.has_direct_effect && found.a.value > 0.0 && found.b.value > 0.0;
  found.critical_slip_m = critical_slip_m(usual->delta_mu, log_rest, log_speed, found.a.value, found.b.value);
  found.S.resize(tests.size());
  found.K_is_lower.resize(tests.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    found.S[of_tests[i]] = found.static_coefficient(places[i].S.x, places[i].log_speed) + lower[i];
    found.K_is_lower[of_tests[i]] = lower[i];
  }
  found.log_pull_length = log_rest + log_speed;
  for (const std::size_t i : holds)
    found.log_hold_speed += places[i].log_speed / static_cast<double>(holds.size());
  return found;
}

}  // namespace stickslip::law
