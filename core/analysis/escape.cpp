#include "core/analysis/escape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <boost/math/tools/toms748_solve.hpp>

#include "core/model/capture.hpp"
#include "core/model/threshold.hpp"

namespace stickslip::analysis {
namespace {

/// A slip with the logarithm of its critical speed.
struct Place {
  double log_speed = 0.0;
  double sign = 1.0;  ///< 1: captured.
};

/// z beyond which Φ(z) is 1 in double precision.
constexpr double kCertain = 8.3;

/// ln Φ(z)
double log_probability(double z) noexcept {
  if (z > kCertain) return 0.0;
  constexpr double kAsymptotic = -30.0;  // Below, Φ nears the least double: φ(z)/−z, to 0.1 %.
  if (z < kAsymptotic) return -0.5 * z * z - std::log(-z * std::sqrt(2.0 * std::numbers::pi));
  return std::log(0.5 * std::erfc(-z / std::numbers::sqrt2));
}

/// Of the mean m of the logarithm of the slips' threshold speeds; concave.
double log_likelihood(const std::vector<Place>& places, double m, double sigma) {
  double sum = 0.0;
  for (const Place& place : places) sum += log_probability(place.sign * (m - place.log_speed) / sigma);
  return sum;
}

struct Believed {
  double mean = 0.0;
  double sd = 0.0;
};

/// Mean and standard deviation of m over its likelihood.
Believed believed(const std::vector<Place>& places, double sigma) {
  const auto [least, most] = std::minmax_element(
      places.begin(), places.end(), [](const Place& a, const Place& b) { return a.log_speed < b.log_speed; });
  // The maximum lies no further out: there even one slip outweighs all others.
  const double margin = sigma * (std::sqrt(2.0 * std::log(static_cast<double>(places.size()) + 1.0)) + 1.0);
  double low = least->log_speed - margin;
  double high = most->log_speed + margin;
  // Golden section: the function is concave.
  constexpr double kGolden = 1.0 / std::numbers::phi;
  double left = high - kGolden * (high - low);
  double right = low + kGolden * (high - low);
  double at_left = log_likelihood(places, left, sigma);
  double at_right = log_likelihood(places, right, sigma);
  while (high - low > 0.01 * sigma) {
    if (at_left > at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = log_likelihood(places, left, sigma);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = log_likelihood(places, right, sigma);
    }
  }
  // One escape among captures has a likelihood of a width of 0.3 σ and more, of smooth functions of σ: steps
  // of half of that leave nothing to the trapezoidal rule, and 6 σ away it is below 1e-7.
  const double mode = 0.5 * (low + high);
  const double top = log_likelihood(places, mode, sigma);
  constexpr int kSteps = 40;
  constexpr double kReach = 6.0;
  double weights = 0.0;
  double first = 0.0;
  double second = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double off = kReach * sigma * i / kSteps;
    const double weight = std::exp(log_likelihood(places, mode + off, sigma) - top);
    weights += weight;
    first += weight * off;
    second += weight * off * off;
  }
  const double mean = first / weights;
  return {mode + mean, std::sqrt(std::max(second / weights - mean * mean, 0.0))};
}

/// Logarithm of the gap between the fastest slip that was captured and the slowest above it that was not.
double gap_of(std::span<const EscapeTrial> trials) {
  double captured = 0.0;
  double escaped = std::numeric_limits<double>::infinity();
  for (const EscapeTrial& trial : trials) {
    if (trial.captured) captured = std::max(captured, trial.critical_speed_m_per_s);
  }
  for (const EscapeTrial& trial : trials) {
    if (!trial.captured && trial.critical_speed_m_per_s >= captured) {
      escaped = std::min(escaped, trial.critical_speed_m_per_s);
    }
  }
  return std::isfinite(escaped) ? std::log(escaped / captured) : 0.0;
}

}  // namespace

EscapeSpeeds escape_speeds(std::span<const EscapeTrial> trials, double scatter) {
  EscapeSpeeds speeds;
  const auto escape =
      std::find_if(trials.begin(), trials.end(), [](const EscapeTrial& trial) { return !trial.captured; });
  const auto before = std::count_if(trials.begin(), escape, [](const auto& trial) { return trial.captured; });
  if (escape == trials.end() || before == 0) {
    const std::string reason =
        escape == trials.end()
            ? "every slip stuck again: the threshold speed was not reached"
            : fmt::format("the first slip did not stick again: the threshold speed lies below {:.4g} m/s",
                          escape->onset_speed_m_per_s);
    return {Estimate::none(reason), Estimate::none(reason)};
  }
  speeds.first_escape = Estimate::of(escape->onset_speed_m_per_s);
  const double of_paper = std::sqrt(std::log1p(scatter * scatter));
  const auto total = [&](double paper) { return std::hypot(paper, gap_of(trials) / std::sqrt(12.0)); };
  const double sigma = total(of_paper);
  // Critical speeds are found to 40 bits.
  constexpr double kNoScatter = 1e-11;
  if (!(sigma > kNoScatter)) {
    speeds.of_mean_paper = Estimate::none("slips at one speed ended in both ways without scatter");
    return speeds;
  }
  std::vector<Place> places;
  for (const EscapeTrial& trial : trials)
    places.push_back({std::log(trial.critical_speed_m_per_s), trial.captured ? 1.0 : -1.0});
  // The mean of a log-normal; the half variance is the paper's alone, not that of the steps of the speed.
  const auto speed = [](const Believed& m, double paper) { return std::exp(m.mean + 0.5 * paper * paper); };
  const Believed m = believed(places, sigma);
  const double best = speed(m, of_paper);
  const double of_place = best * m.sd;
  const double step = of_paper / std::sqrt(2.0 * std::max(static_cast<double>(trials.size()) - 1.0, 1.0));
  const double of_scatter = step > 0.0
                                ? 0.5 * (speed(believed(places, total(of_paper + step)), of_paper + step) -
                                         speed(believed(places, total(of_paper - step)), of_paper - step))
                                : 0.0;
  speeds.of_mean_paper = Estimate::of(best, std::hypot(of_place, of_scatter));
  return speeds;
}

std::vector<EscapeTrial> escape_trials(const SlipEstimates& estimates) {
  std::vector<EscapeTrial> trials;
  const model::SharedParameters& shared = estimates.fit.shared;
  const model::Oscillator oscillator = shared.oscillator();
  const model::BeltMotion& belt = estimates.belt;
  if (belt.is_constant() || !(shared.gamma > 0.0)) return trials;
  const double Q_th = model::Q_threshold(oscillator.gamma_over_2omega());
  for (std::size_t i = 0; i < estimates.ends.size(); ++i) {
    const bool begins = i == 0 || estimates.window_of_slip[i] != estimates.window_of_slip[i - 1];
    if (!begins || !estimates.has_window(i) || estimates.ends[i] == SlipEnd::kUnknown) continue;
    const double onset_s = estimates.windows[estimates.window_of_slip[i]].slip.onset_s;
    const double rate = belt.stick_rate(shared.r, onset_s);
    const double share = belt.acceleration_share(shared.r, oscillator.omega0_squared(), onset_s);
    // How much faster than the belt c′ gets with this S − K.
    const auto excess = [&](double delta_mu) {
      const model::SlipWaveform slip{0.0, delta_mu - share, rate, oscillator};
      const double t_s = model::deciding_time_s(slip, belt, shared.r, onset_s);
      return slip.rate(t_s) - belt.stick_rate(shared.r, onset_s + t_s);
    };
    const double steady = rate / (Q_th * oscillator.omega_rad_per_s());
    const double low = 0.25 * steady;
    const double high = 4.0 * steady;
    const double at_low = excess(low);
    const double at_high = excess(high);
    if (!(at_low < 0.0 && at_high > 0.0)) continue;  // The belt is about to stop: no speed decides there.
    std::uintmax_t iterations = 100;
    const auto root = boost::math::tools::toms748_solve(
        excess, low, high, at_low, at_high, boost::math::tools::eps_tolerance<double>(40), iterations);
    const double speed_m_per_s = belt.plan().speed_m_per_s(onset_s - belt.start_s());
    trials.push_back({speed_m_per_s, speed_m_per_s * 0.5 * (root.first + root.second) / steady,
                      estimates.ends[i] == SlipEnd::kCaptured});
  }
  return trials;
}

std::optional<double> delta_mu_scatter(const SlipEstimates& estimates) {
  double mean = 0.0;
  double squares = 0.0;
  double noise = 0.0;
  double n = 0.0;
  for (const estimate::SlipWindow& window : estimates.windows) {
    const double D = estimates.static_coefficient(window) - window.slip.K;
    n += 1.0;
    const double delta = D - mean;
    mean += delta / n;
    squares += delta * (D - mean);
    const Eigen::Matrix3d& own = window.inverse_curvature;
    noise += own(1, 1) + own(2, 2) - 2.0 * own(1, 2);
  }
  if (n < 3.0 || !(mean > 0.0)) return std::nullopt;
  return std::sqrt(std::max(squares / (n - 1.0) - noise / n, 0.0)) / mean;
}

}  // namespace stickslip::analysis
