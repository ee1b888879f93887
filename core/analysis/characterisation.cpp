#include "core/analysis/characterisation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <boost/math/distributions/chi_squared.hpp>

#include "core/base/digits.hpp"

namespace stickslip::analysis {
namespace {

/// Standard errors by which the speed must be off before it is a finding.
constexpr double kSpeedSigmas = 3.0;

double probability_of(double chi_squared, double freedom) {
  return boost::math::cdf(
      boost::math::complement(boost::math::chi_squared_distribution<double>{freedom}, chi_squared));
}

Eigen::Vector2d coupling_of(const TesterEstimate& estimate) {
  return {estimate.omega, estimate.gamma_over_2omega};
}

}  // namespace

TesterEstimate TesterEstimate::from(const model::SharedParameters& shared,
                                    const Eigen::Matrix3d& covariance) {
  const auto& [omega, gamma, r] = shared;
  const double omega0_squared = omega * omega + 0.25 * gamma * gamma;
  TesterEstimate estimate;
  estimate.omega = omega;
  estimate.gamma_over_2omega = gamma / (2.0 * omega);
  estimate.speed_over_gravity_s = r / omega0_squared;
  Eigen::Matrix3d slope = Eigen::Matrix3d::Identity();
  slope.row(1) << -estimate.gamma_over_2omega / omega, 1.0 / (2.0 * omega), 0.0;
  const double v = estimate.speed_over_gravity_s;
  slope.row(2) << -2.0 * omega * v / omega0_squared, -0.5 * gamma * v / omega0_squared, 1.0 / omega0_squared;
  estimate.covariance = slope * covariance * slope.transpose();
  return estimate;
}

double Characterisation::probability() const {
  return freedom > 0 ? probability_of(chi_squared, static_cast<double>(freedom)) : 1.0;
}

std::optional<Characterisation> pool_ring_downs(std::span<const TesterEstimate> ring_downs) {
  Eigen::Matrix2d weight = Eigen::Matrix2d::Zero();
  Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  for (const TesterEstimate& ring_down : ring_downs) {
    const Eigen::Matrix2d one = Eigen::Matrix2d{ring_down.covariance.topLeftCorner<2, 2>()}.inverse();
    weight += one;
    weighted += one * coupling_of(ring_down);
  }
  const Eigen::Matrix2d covariance = weight.inverse();
  const Eigen::Vector2d mean = covariance * weighted;
  if (ring_downs.empty() || !covariance.allFinite() || !mean.allFinite()) return std::nullopt;
  Characterisation result;
  result.ring_downs = static_cast<int>(ring_downs.size());
  result.freedom = 2 * (result.ring_downs - 1);
  for (const TesterEstimate& ring_down : ring_downs) {
    const Eigen::Vector2d off = coupling_of(ring_down) - mean;
    const Eigen::Matrix2d one = Eigen::Matrix2d{ring_down.covariance.topLeftCorner<2, 2>()}.inverse();
    result.chi_squared += off.dot(one * off);
  }
  const double ratio = result.freedom > 0 ? std::max(result.chi_squared / result.freedom, 1.0) : 1.0;
  result.coupling = {mean[0], mean[1], ratio * covariance};
  return result;
}

Estimate pull_speed_of(const TesterEstimate& estimate, double gravity_m_per_s2) {
  return Estimate::of(estimate.speed_over_gravity_s * gravity_m_per_s2,
                      std::sqrt(estimate.covariance(2, 2)) * gravity_m_per_s2);
}

Estimate slope_of_friction(const TesterEstimate& found, const estimate::SharedPrior::Coupling& known,
                           double gravity_m_per_s2) {
  const auto damping = [](double omega, double gamma_over_2omega, const Eigen::Matrix2d& covariance) {
    const Eigen::Vector2d gradient{2.0 * gamma_over_2omega, 2.0 * omega};
    return std::pair{2.0 * omega * gamma_over_2omega, gradient.dot(covariance * gradient)};
  };
  const auto [here, of_here] =
      damping(found.omega, found.gamma_over_2omega, found.covariance.topLeftCorner<2, 2>());
  const auto [there, of_there] = damping(known.omega, known.gamma_over_2omega, known.covariance);
  return Estimate::of((here - there) / gravity_m_per_s2, std::sqrt(of_here + of_there) / gravity_m_per_s2);
}

double probability_of_agreement(std::span<const Estimate> estimates) {
  double weight = 0.0;
  double mean = 0.0;
  for (const Estimate& estimate : estimates) {
    const double own = 1.0 / (*estimate.standard_error * *estimate.standard_error);
    weight += own;
    mean += own / weight * (*estimate.value - mean);
  }
  double chi_squared = 0.0;
  for (const Estimate& estimate : estimates)
    chi_squared += std::pow((*estimate.value - mean) / *estimate.standard_error, 2);
  return probability_of(chi_squared, static_cast<double>(estimates.size() - 1));
}

namespace {

/// In the unit of the plan, with two significant digits of the error.
std::string speed_sentence(double measured_m_per_s, double error_m_per_s, double plan_m_per_s) {
  const base::SpeedUnit unit = base::unit_of_speed(plan_m_per_s);
  const double error = error_m_per_s / unit.m_per_s;
  constexpr int kExact = 6;  // Decimals of a speed whose error is zero.
  const int decimals = error > 0.0 ? std::max(base::decimals_of(error, base::kUncertaintyDigits), 0) : kExact;
  return fmt::format("the pull speed was {:.{}f} +- {:.{}f} {}, the plan says {}",
                     measured_m_per_s / unit.m_per_s, decimals, error, decimals, unit.symbol,
                     unit.text(plan_m_per_s));
}

}  // namespace

std::optional<base::Finding> speed_finding(const Estimate& measured_m_per_s, const model::Tester& tester) {
  if (!tester.pull_speed_m_per_s || !measured_m_per_s.value || !measured_m_per_s.standard_error) {
    return std::nullopt;
  }
  const double plan = *tester.pull_speed_m_per_s;
  const double error = *measured_m_per_s.standard_error;
  const double difference = std::abs(*measured_m_per_s.value - plan);
  if (!(difference > kSpeedTolerance * plan && difference > kSpeedSigmas * error)) return std::nullopt;
  return base::make_finding(base::FindingCode::kPullSpeed,
                            speed_sentence(*measured_m_per_s.value, error, plan),
                            {{"pull_speed_measured", *measured_m_per_s.value, "m/s"},
                             {"standard_error", error, "m/s"},
                             {"pull_speed", plan, "m/s"}});
}

TesterCheck check_tester(const TesterEstimate& alone, const TesterEstimate& with,
                         const estimate::SharedPrior::Coupling& known, const model::Tester& tester) {
  TesterCheck check;
  const Eigen::Vector2d off = coupling_of(alone) - Eigen::Vector2d{known.omega, known.gamma_over_2omega};
  const Eigen::Matrix2d spread = alone.covariance.topLeftCorner<2, 2>() + known.covariance;
  check.chi_squared = off.dot(spread.inverse() * off);
  check.probability = std::isfinite(check.chi_squared) ? probability_of(check.chi_squared, 2.0) : 0.0;
  if (!check.agrees()) {
    base::add(
        check.findings,
        base::make_finding(
            base::FindingCode::kTesterChanged,
            fmt::format(
                "the tester or the paper has changed since the characterisation: chi-squared {:.1f} for 2 "
                "(omega {:.3f} rad/s here, "
                "{:.3f} there; gamma/2omega {:.5f} here, {:.5f} there), so that it was {}",
                check.chi_squared, alone.omega, known.omega, alone.gamma_over_2omega, known.gamma_over_2omega,
                check.used() ? "used with doubt" : "not used"),
            {{"chi_squared", check.chi_squared, "1"},
             {"omega", alone.omega, "rad/s"},
             {"omega_characterised", known.omega, "rad/s"},
             {"gamma_over_2omega", alone.gamma_over_2omega, "1"},
             {"gamma_over_2omega_characterised", known.gamma_over_2omega, "1"}}));
  }
  const TesterEstimate& best = check.used() ? with : alone;
  check.pull_speed = pull_speed_of(best, tester.gravity_m_per_s2);
  if (auto finding = speed_finding(check.pull_speed, tester)) base::add(check.findings, *std::move(finding));
  return check;
}

}  // namespace stickslip::analysis
