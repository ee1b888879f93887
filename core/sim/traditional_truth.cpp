#include "core/sim/traditional_truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/sim/motion_solver.hpp"

namespace stickslip::sim {
namespace {

/// Points in each free period. The largest of them is below a maximum by at most
/// 1 − cos(π/2000) = 1.2e-6 of the amplitude, and the mean is as close.
constexpr double kPointsPerPeriod = 2000.0;

/// Takes the force point by point; maxima and means as the rule wants them.
class Reader {
 public:
  /// \param points_per_m  of travel.
  Reader(const model::Method& method, double points_per_m) : method_(method) {
    if (!method.kinetic_travel) return;
    first_ = method.kinetic_travel->from_m * points_per_m;
    end_ = method.kinetic_travel->to_m * points_per_m;
  }

  void add(double now) {
    if (++seen_ > 2 && last_ > before_ && last_ >= now) ++maxima_;
    const bool is_maximum = maxima_ != maxima_before_;
    maxima_before_ = maxima_;
    if (is_maximum && maxima_ == method_.static_slip) truth_.static_coefficient = last_;
    if (!truth_.kinetic_coefficient && maxima_ > 0) average(is_maximum);
    before_ = last_;
    last_ = now;
  }

  [[nodiscard]] bool done() const noexcept { return truth_.static_coefficient && truth_.kinetic_coefficient; }
  [[nodiscard]] const TraditionalTruth& truth() const noexcept { return truth_; }

 private:
  /// The point before belongs to the mean, or the mean is whole.
  void average(bool is_maximum) {
    const bool whole = method_.kinetic_travel ? points_since_peak_ >= end_
                                              : is_maximum && maxima_ == method_.kinetic_cycles + 1;
    if (whole) {
      if (count_ > 0.0) truth_.kinetic_coefficient = mean_;
      return;
    }
    if (points_since_peak_++ >= first_) mean_ += (last_ - mean_) / ++count_;
  }

  model::Method method_;
  double first_ = 0.0;  ///< Points after the first peak at which the mean begins,
  double end_ = 0.0;    ///< and ends; only for a travel.
  TraditionalTruth truth_;
  double before_ = 0.0;
  double last_ = 0.0;
  double mean_ = 0.0;
  double count_ = 0.0;
  double points_since_peak_ = 0.0;
  int maxima_ = 0;
  int maxima_before_ = 0;
  std::int64_t seen_ = 0;
};

}  // namespace

TraditionalTruth traditional_truth(const Scene& scene, std::uint64_t seed, double onset_s,
                                   const model::Method& method, double pull_speed_m_per_s) {
  const double rate_Hz = kPointsPerPeriod * scene.oscillator.omega_rad_per_s() / (2.0 * std::numbers::pi);
  const auto from = static_cast<std::int64_t>(std::floor(onset_s * rate_Hz));
  const auto end = static_cast<std::int64_t>(std::ceil(pull_of(scene)->end_s * rate_Hz));
  const auto motion = make_motion_solver(motion_of(scene), rate_Hz, scene.accuracy, nullptr, seed);
  motion->skip(from);

  Reader reader{method, rate_Hz / pull_speed_m_per_s};
  std::array<double, 256> force{};
  for (std::int64_t at = from; at < end && !reader.done(); at += static_cast<std::int64_t>(force.size())) {
    const auto left = static_cast<std::size_t>(end - at);
    const std::span<double> points = std::span{force}.first(std::min(left, force.size()));
    motion->next(points);
    for (const double now : points) reader.add(now);
  }
  return reader.truth();
}

}  // namespace stickslip::sim
