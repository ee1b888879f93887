#include "core/friction/junction.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/friction/capture.hpp"
#include "core/friction/huber.hpp"

namespace stickslip::friction {
namespace {

/// Fewest scans on which four parameters and a choice make sense.
constexpr std::size_t kFewestScans = 8;
constexpr int kMostIterations = 40;
constexpr double kFirstDamping = 1e-3;
constexpr double kHopeless = 1e8;
constexpr double kConverged = 1e-6;  ///< Log-likelihood units.
/// Standard deviation of ln(S − K) of paper at most: √ln(1 + 0.6²), for a scatter of 60 %.
constexpr double kLogScatter = 0.5545;
/// Keeps the logarithm finite.
constexpr double kLeastRatio = 1e-6;

struct Scan {
  double tau_s;  ///< After the first scan of the window.
  double value;
};

/// All scans of a window, unless the stick or what is left of an oscillation is so long that the time for
/// the fit and its memory would grow with it: then all near the two ends, where the slips are, and of the
/// line between them so many that there are about kMostScans.
class Selection {
 public:
  Selection(std::size_t first, std::size_t end)
      : first_(first), end_(end), stride_((end - first + kMostScans - 1) / kMostScans) {}

  [[nodiscard]] bool has(std::size_t k) const noexcept {
    return k - first_ < kNearTheEnds || end_ - k <= kNearTheEnds || (k - first_) % stride_ == 0;
  }

 private:
  static constexpr std::size_t kMostScans = 20'000;   ///< A minute at 350 scans/s.
  static constexpr std::size_t kNearTheEnds = 5'000;  ///< From each end.

  std::size_t first_;
  std::size_t end_;
  std::size_t stride_;
};

/// K, c(0) − K, c′(0), and for "captured" the S of the next slip.
using Parameters = Eigen::VectorXd;

class FreeCourse {
 public:
  FreeCourse(const Parameters& p, const SharedParameters& shared)
      : waveform_{p[0], p[1], p[2], shared.oscillator()} {}

  [[nodiscard]] double value(double tau_s) const { return waveform_.value(tau_s); }
  [[nodiscard]] static double surprise() noexcept { return 0.0; }

 private:
  SlipWaveform waveform_;
};

/// The captured course with its events worked out once.
class CapturedCourse {
 public:
  /// \param belt  outlives this. \param start_s  time of the trace at τ = 0.
  CapturedCourse(const Parameters& p, const SharedParameters& shared, double typical_delta_mu,
                 const BeltCourse& belt, double start_s)
      : r_(shared.r), belt_(belt), start_s_(start_s), first_{p[0], p[1], p[2], shared.oscillator()} {
    capture_s_ = capture_time_s(first_, belt, r_, start_s).value_or(first_.rise_end_time_s());
    at_capture_ = first_.value(capture_s_);
    const double S = std::max({p[3], p[0], at_capture_});
    onset_s_ = capture_s_ + belt.climbing_time_s(r_, start_s + capture_s_, S - at_capture_);
    second_ = SlipWaveform{p[0], S - p[0], belt.stick_rate(r_, start_s + onset_s_), shared.oscillator()};
    surprise_ = std::log(std::max((S - p[0]) / typical_delta_mu, kLeastRatio)) / kLogScatter;
  }

  /// How unusual its S − K is, in standard deviations.
  [[nodiscard]] double surprise() const noexcept { return surprise_; }

  [[nodiscard]] double value(double tau_s) const {
    if (tau_s <= capture_s_) return first_.value(tau_s);
    if (tau_s <= onset_s_) return at_capture_ + belt_.climb(r_, start_s_ + capture_s_, tau_s - capture_s_);
    return second_.value(tau_s - onset_s_);
  }

 private:
  double r_;
  const BeltCourse& belt_;
  double start_s_;
  SlipWaveform first_;
  SlipWaveform second_;
  double capture_s_ = 0.0;
  double at_capture_ = 0.0;
  double onset_s_ = 0.0;
  double surprise_ = 0.0;
};

/// Huber's cost of the residuals over σ, which it fills (a spike that was not found counts no more for one
/// course than for the other), with the surprise as the last of them.
template <typename Course>
double cost_of(const std::vector<Scan>& scans, const Course& course, double sigma,
               Eigen::VectorXd& residuals) {
  residuals[static_cast<Eigen::Index>(scans.size())] = -course.surprise();
  double cost = 0.5 * course.surprise() * course.surprise();
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const double z = (scans[i].value - course.value(scans[i].tau_s)) / sigma;
    residuals[static_cast<Eigen::Index>(i)] = z;
    cost += huber_cost(z);
  }
  return cost;
}

/// Levenberg–Marquardt with difference quotients; `steps` are the parameters' scales.
/// \param model  called as model(parameters) → course.
template <typename Model>
double least_cost(const std::vector<Scan>& scans, const Model& model, Parameters p, const Parameters& steps,
                  double sigma) {
  const auto rows = static_cast<Eigen::Index>(scans.size()) + 1;
  Eigen::VectorXd residuals(rows);
  Eigen::VectorXd shifted(rows);
  Eigen::MatrixXd jacobian(rows, p.size());
  double cost = cost_of(scans, model(p), sigma, residuals);
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < kMostIterations && damping < kHopeless; ++iteration) {
    for (Eigen::Index j = 0; j < p.size(); ++j) {
      Parameters moved = p;
      moved[j] += steps[j];
      cost_of(scans, model(moved), sigma, shifted);
      jacobian.col(j) = (residuals - shifted) / steps[j];
    }
    Eigen::VectorXd weights = residuals.unaryExpr([](double z) { return huber_weight(z); });
    weights[rows - 1] = 1.0;
    Eigen::MatrixXd normal = jacobian.transpose() * weights.asDiagonal() * jacobian;
    normal.diagonal() *= 1.0 + damping;
    const Parameters trial = p + normal.ldlt().solve(jacobian.transpose() * weights.cwiseProduct(residuals));
    const double trial_cost = trial.allFinite() ? cost_of(scans, model(trial), sigma, shifted) : cost + 1.0;
    if (trial_cost > cost) {
      damping *= 10.0;
      continue;
    }
    const bool converged = cost - trial_cost < kConverged;
    p = trial;
    cost = trial_cost;
    residuals = shifted;
    damping *= 0.1;
    if (converged) break;
  }
  return cost;
}

}  // namespace

double capture_log_likelihood_ratio(const Trace& trace, std::size_t first, std::size_t end,
                                    const SharedParameters& shared, double sigma, double typical_delta_mu) {
  std::vector<Scan> scans;
  const Selection selection{first, end};
  double low = 0.0;
  double high = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    if (!selection.has(k) || trace.usable[k] == 0) continue;
    const double value = trace.level(k);
    low = scans.empty() ? value : std::min(low, value);
    high = scans.empty() ? value : std::max(high, value);
    scans.push_back({trace.time_s[k] - trace.time_s[first], value});
  }
  if (scans.size() < kFewestScans) return 0.0;

  const double swing = high - low;
  // Difference quotients: a small part of the swing, far above the rounding of the values.
  const double step = 1e-5 * swing;
  const Eigen::Vector3d free_start{0.5 * (low + high), 0.5 * swing, 0.0};
  const Eigen::Vector3d free_steps{step, step, step * shared.omega};
  const double free_cost = least_cost(
      scans,
      [&](const Parameters& p) {
        return FreeCourse{p, shared};
      },
      free_start, free_steps, sigma);

  const auto captured = [&](const Parameters& p) {
    return CapturedCourse{p, shared, typical_delta_mu, trace.belt, trace.time_s[first]};
  };
  // Two starts: S as high as the swing says, and just above K; the cost has both valleys.
  const double amplitude_of_belt = trace.belt.stick_rate(shared.r, trace.time_s[first]) / shared.omega;
  const double D = std::sqrt(std::max(0.25 * swing * swing - amplitude_of_belt * amplitude_of_belt, 0.0));
  const Eigen::Vector4d steps{step, step, step * shared.omega, step};
  double captured_cost = 0.0;
  for (int start = 0; start < 2; ++start) {
    const double S = free_start[0] + (start == 0 ? D : 0.1 * swing);
    const double cost =
        least_cost(scans, captured, Eigen::Vector4d{free_start[0], free_start[1], 0.0, S}, steps, sigma);
    captured_cost = start == 0 ? cost : std::min(captured_cost, cost);
  }
  return free_cost - captured_cost;
}

}  // namespace stickslip::friction
