#include "core/detect/fall_heights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/detect/junction.hpp"
#include "core/detect/slip_rule.hpp"

namespace stickslip::detect {
namespace {

/// Relative uncertainty of a free oscillation's decay without a characterisation of the tester.
constexpr double kDampingError = 0.3;
/// Error of a drop by peaks between scans, relative to the drop.
constexpr double kPeakError = 0.02;

double log_normal_density(double x, double mean, double deviation) noexcept {
  const double z = (x - mean) / deviation;
  return -0.5 * z * z - std::log(deviation);
}

}  // namespace

double FallHeights::freely_next(double drop, double gamma_over_2omega) noexcept {
  return drop * std::exp(-2.0 * std::numbers::pi * gamma_over_2omega);
}

bool FallHeights::is_more_than(double drop, double freely_next, double sigma) noexcept {
  // Noise of both ends as far as it makes no turning point.
  const double noise = std::numbers::sqrt2 * SlipRule::kHysteresisSigmas * sigma;
  return drop > freely_next + noise + kPeakError * drop;
}

double FallHeights::evidence(double drop, double next_drop, double freely_next, bool is_damping_known,
                             double sigma) noexcept {
  // A free oscillation falls next time by what damping leaves; a slip from sticking by what is usual.
  const double scans = std::numbers::sqrt2 * sigma;
  const double between_scans = kPeakError * freely_next;
  const double damping = is_damping_known ? 0.0 : kDampingError * freely_next;
  const double noise = std::sqrt(scans * scans + between_scans * between_scans + damping * damping);
  if (count_ == 0.0) usual_log_drop_ = std::log(drop);
  const double log_drop = std::log(next_drop);
  off_usual_ = log_drop - usual_log_drop_;
  const double as_captured = log_normal_density(off_usual_, 0.0, kDeltaMuLogScatter) - log_drop;
  return as_captured - log_normal_density(next_drop, freely_next, noise);
}

void FallHeights::learn() noexcept {
  count_ = std::min(count_ + 1.0, kMemory);
  usual_log_drop_ += off_usual_ / count_;
}

double FallHeights::usual_drop(double otherwise) const noexcept {
  return count_ > 0.0 ? std::exp(usual_log_drop_) : otherwise;
}

}  // namespace stickslip::detect
