#include "core/detect/junction.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/detect/junction_scans.hpp"
#include "core/estimate/huber.hpp"
#include "core/estimate/levenberg_marquardt.hpp"
#include "core/model/capture.hpp"

namespace stickslip::detect {
namespace {

/// Fewest scans for a decision: twice the four parameters.
constexpr std::size_t kFewestJunctionScans = 8;
constexpr int kMostJunctionIterations = 40;
constexpr double kJunctionConverged = 1e-6;  ///< Log-likelihood units.

/// K, c(0) − K, c′(0), and for "captured" the S of the next slip.
template <int kCount>
using Parameters = Eigen::Matrix<double, kCount, 1>;

/// Value of a course at a point, and its derivatives by the parameters.
template <int kCount>
struct CoursePoint {
  double value = 0.0;
  Parameters<kCount> by = Parameters<kCount>::Zero();
};

class FreeCourse {
 public:
  static constexpr int kCount = 3;

  FreeCourse(const Parameters<kCount>& p, const model::SharedParameters& shared)
      : p_(p), damping_(0.5 * shared.gamma / shared.omega), per_omega_(1.0 / shared.omega) {}

  [[nodiscard]] CoursePoint<kCount> at(const JunctionPoint& point) const noexcept {
    const double by_D = point.cosine + damping_ * point.sine;
    const double by_rate = per_omega_ * point.sine;
    return {p_[0] + p_[1] * by_D + p_[2] * by_rate, {1.0, by_D, by_rate}};
  }
  [[nodiscard]] const Parameters<kCount>& parameters() const noexcept { return p_; }
  [[nodiscard]] static std::array<CoursePoint<kCount>, 0> surprises() noexcept { return {}; }

 private:
  Parameters<kCount> p_;
  double damping_;  ///< γ/2ω
  double per_omega_;
};

/// The captured course with its events worked out once.
class CapturedCourse {
 public:
  static constexpr int kCount = 4;

  /// \param belt  outlives this. \param start_s  time of the trace at τ = 0.
  CapturedCourse(const Parameters<kCount>& p, const model::SharedParameters& shared, double typical_delta_mu,
                 double last_s, const model::BeltCourse& belt, double start_s)
      : belt_(belt),
        start_s_(start_s),
        r_(shared.r),
        first_(p.head<3>(), shared),
        damping_(0.5 * shared.gamma / shared.omega),
        omega_(shared.omega),
        K_(p[0]) {
    const model::SlipWaveform slip{p[0], p[1], p[2], shared.oscillator()};
    const auto captured_s = model::capture_time_s(slip, belt, r_, start_s);
    capture_s_ = captured_s.value_or(slip.rise_end_time_s());
    JunctionPoint capture;
    const double decay = std::exp(-0.5 * shared.gamma * capture_s_);
    capture.cosine = decay * std::cos(omega_ * capture_s_);
    capture.sine = decay * std::sin(omega_ * capture_s_);
    at_capture_ = first_.at(capture);
    // At a capture c′ is the stick rate but for rounding, which is not a shortfall.
    if (!captured_s) shortfall_ = shortfall(capture);
    const double S = std::max({p[3], K_, at_capture_.value});
    D_ = S - K_;
    onset_s_ = capture_s_ + belt.climbing_time_s(r_, start_s + capture_s_, S - at_capture_.value);
    onset_rate_ = belt.stick_rate(r_, start_s + onset_s_);
    onset_slope_ = r_ * belt.slope(start_s + onset_s_);
    // c = K + e^(−γt/2) [D cos ωt + B sin ωt] from the onset on: (11) without a division by D. Counted from
    // the last point, the onset turns and stretches the two.
    const double onset_to_end_s = onset_s_ - last_s;
    const double growth = std::exp(0.5 * shared.gamma * onset_to_end_s);
    cosine_ = growth * std::cos(omega_ * onset_to_end_s);
    sine_ = growth * std::sin(omega_ * onset_to_end_s);
    ratio_ = std::max(D_ / typical_delta_mu, kLeastRatio);
    sure_ = ratio_ > kLeastRatio;
  }

  /// What of it is unusual, in standard deviations: its S − K, and a c′ that does not reach the stick rate.
  [[nodiscard]] std::array<CoursePoint<kCount>, 2> surprises() const noexcept {
    CoursePoint<kCount> point{std::log(ratio_) / kDeltaMuLogScatter, Parameters<kCount>::Zero()};
    if (sure_) point.by << -1.0 / (D_ * kDeltaMuLogScatter), 0.0, 0.0, 1.0 / (D_ * kDeltaMuLogScatter);
    return {point, shortfall_};
  }

  [[nodiscard]] CoursePoint<kCount> at(const JunctionPoint& point) const noexcept {
    if (point.tau_s <= capture_s_) return widened(first_.at(point));
    // c and c′ are continuous at the capture, so its shift drops out of the derivatives.
    CoursePoint<kCount> course = widened(at_capture_);
    if (point.tau_s <= onset_s_) {
      course.value += belt_.climb(r_, start_s_ + capture_s_, point.tau_s - capture_s_);
      return course;
    }
    const double cosine = point.cosine_to_end * cosine_ + point.sine_to_end * sine_;
    const double sine = point.sine_to_end * cosine_ - point.cosine_to_end * sine_;
    const double by_D = cosine + damping_ * sine;
    course.value = K_ + D_ * by_D + onset_rate_ / omega_ * sine;
    // c′ = e^(−γt/2) [r cos ωt − (γ/2ω r + ω₀² D/ω) sin ωt] [12]; ω₀² = ω² (1 + (γ/2ω)²).
    const double rate =
        onset_rate_ * cosine - (damping_ * onset_rate_ + omega_ * (1.0 + damping_ * damping_) * D_) * sine;
    // The onset is later by (∂S − ∂c(capture))/r, and the slip begins with what the belt's rate is then.
    const double later = (rate - onset_slope_ / omega_ * sine) / onset_rate_;
    course.by *= later;
    course.by[0] += 1.0 - by_D;
    course.by[3] = by_D - later;
    return course;
  }

 private:
  /// \param at  the capture. At the end of its rise c′ is stationary, so that the shift of that moment drops
  /// out.
  [[nodiscard]] CoursePoint<kCount> shortfall(const JunctionPoint& at) const noexcept {
    const double spread = kStickRateSpread * belt_.stick_rate(r_, start_s_ + capture_s_);
    const double omega0_squared = omega_ * omega_ * (1.0 + damping_ * damping_);
    const Eigen::Vector3d rate_by{0.0, -omega0_squared / omega_ * at.sine, at.cosine - damping_ * at.sine};
    const double missing = belt_.stick_rate(r_, start_s_ + capture_s_) - rate_by.dot(first_.parameters());
    if (!(missing > 0.0)) return {0.0, Parameters<kCount>::Zero()};
    return widened({missing / spread, -rate_by / spread});
  }
  [[nodiscard]] static CoursePoint<kCount> widened(const CoursePoint<3>& point) noexcept {
    return {point.value, {point.by[0], point.by[1], point.by[2], 0.0}};
  }

  const model::BeltCourse& belt_;
  double start_s_;
  double r_;
  FreeCourse first_;
  double damping_;  ///< γ/2ω
  double omega_;
  double K_;
  double D_ = 0.0;  ///< S − K of the second slip.
  double capture_s_ = 0.0;
  CoursePoint<3> at_capture_;
  CoursePoint<kCount> shortfall_;
  double onset_s_ = 0.0;
  double onset_rate_ = 0.0;   ///< Of the belt at the onset, 1/s,
  double onset_slope_ = 0.0;  ///< and its slope, 1/s².
  double cosine_ = 0.0;
  double sine_ = 0.0;
  double ratio_ = 1.0;  ///< S − K over the typical one.
  bool sure_ = true;
};

/// Normal equations of Huber's cost (a spike that was not found counts no more for one course than for the
/// other) with what is unusual as more residuals.
template <int kCount>
struct JunctionEquations {
  Eigen::Matrix<double, kCount, kCount> normal = Eigen::Matrix<double, kCount, kCount>::Zero();
  Parameters<kCount> gradient = Parameters<kCount>::Zero();
  double cost = 0.0;
};

template <typename Course>
JunctionEquations<Course::kCount> equations_of(const JunctionScans& scans, const Course& course,
                                               double sigma) {
  JunctionEquations<Course::kCount> equations;
  for (const CoursePoint<Course::kCount>& surprise : course.surprises()) {
    equations.normal += surprise.by * surprise.by.transpose();
    equations.gradient -= surprise.value * surprise.by;
    equations.cost += 0.5 * surprise.value * surprise.value;
  }
  const double per_sigma = 1.0 / sigma;
  for (const JunctionPoint& point : scans.points()) {
    const CoursePoint<Course::kCount> model = course.at(point);
    const double scale = point.root_count * per_sigma;
    const double z = scale * (point.value - model.value);
    const double weight = scale * estimate::huber_weight(z, kChoiceLimit);
    equations.cost += estimate::huber_cost(z, kChoiceLimit);
    equations.normal += (weight * scale) * model.by * model.by.transpose();
    equations.gradient += (weight * z) * model.by;
  }
  return equations;
}

/// Levenberg–Marquardt. \param make  called as make(parameters) → course.
template <int kCount, typename Make>
double least_cost(const JunctionScans& scans, const Make& make, Parameters<kCount> p, double sigma) {
  JunctionEquations<kCount> equations = equations_of(scans, make(p), sigma);
  double damping = estimate::kFirstDamping;
  for (int iteration = 0; iteration < kMostJunctionIterations && damping < estimate::kHopeless; ++iteration) {
    Eigen::Matrix<double, kCount, kCount> damped = equations.normal;
    damped.diagonal() *= 1.0 + damping;
    const Parameters<kCount> trial = p + damped.ldlt().solve(equations.gradient);
    if (!trial.allFinite()) return equations.cost;
    const JunctionEquations<kCount> there = equations_of(scans, make(trial), sigma);
    if (!(there.cost <= equations.cost)) {
      damping *= 10.0;
      continue;
    }
    const bool converged = equations.cost - there.cost < kJunctionConverged;
    p = trial;
    equations = there;
    damping *= 0.1;
    if (converged) break;
  }
  return equations.cost;
}

}  // namespace

double capture_log_likelihood_ratio(const estimate::Trace& trace, std::size_t first, std::size_t end,
                                    const model::SharedParameters& shared, double sigma,
                                    double typical_delta_mu) {
  JunctionScans scans;
  scans.read(trace, first, end, shared);
  if (scans.scan_count() < kFewestJunctionScans) return 0.0;

  const double swing = scans.highest() - scans.lowest();
  const double middle = 0.5 * (scans.lowest() + scans.highest());
  const double free_cost = least_cost<3>(
      scans,
      [&](const Parameters<3>& p) {
        return FreeCourse{p, shared};
      },
      {middle, 0.5 * swing, 0.0}, sigma);

  const double last_s = scans.points().back().tau_s;
  const auto captured = [&](const Parameters<4>& p) {
    return CapturedCourse{p, shared, typical_delta_mu, last_s, trace.belt, trace.time_s[first]};
  };
  // Two starts: S as high as the swing says, and just above K; the cost has both valleys.
  const double amplitude_of_belt = trace.belt.stick_rate(shared.r, trace.time_s[first]) / shared.omega;
  const double D = std::sqrt(std::max(0.25 * swing * swing - amplitude_of_belt * amplitude_of_belt, 0.0));
  double captured_cost = 0.0;
  for (int start = 0; start < 2; ++start) {
    const double S = middle + (start == 0 ? D : 0.1 * swing);
    const double cost = least_cost<4>(scans, captured, {middle, 0.5 * swing, 0.0, S}, sigma);
    captured_cost = start == 0 ? cost : std::min(captured_cost, cost);
  }
  return free_cost - captured_cost;
}

}  // namespace stickslip::detect
