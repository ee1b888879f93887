#include "core/detect/junction_scans.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stickslip::detect {
namespace {

/// From a peak to the end of its slip, and from an onset to the trough after it, take less than a period.
constexpr double kSlipPeriods = 1.25;
constexpr std::size_t kPointsOfSlip = 96;
constexpr std::size_t kPointsOfStick = JunctionScans::kMostPoints - 2 * kPointsOfSlip;

std::size_t divided_up(std::size_t count, std::size_t parts) { return (count + parts - 1) / parts; }

/// How many neighbours make a point.
class Blocks {
 public:
  Blocks(std::size_t first, std::size_t end, double scans_of_slip)
      : first_(first), end_(end), slip_(static_cast<std::size_t>(scans_of_slip)) {
    const std::size_t count = end - first;
    if (count > 2 * slip_) {
      slip_block_ = divided_up(slip_, kPointsOfSlip);
      stick_block_ = divided_up(count - 2 * slip_, kPointsOfStick);
    } else {
      slip_block_ = divided_up(count, JunctionScans::kMostPoints);
    }
    if (count <= JunctionScans::kMostPoints) slip_block_ = stick_block_ = 1;
  }

  /// The point with scan k ends with it.
  [[nodiscard]] bool last(std::size_t k) const noexcept {
    const std::size_t at = k + 1 - first_;
    if (at < slip_) return at % slip_block_ == 0;
    if (at == slip_ || k + 1 == end_ - slip_ || k + 1 == end_) return true;
    if (end_ - k - 1 < slip_) return (at - (end_ - slip_ - first_)) % slip_block_ == 0;
    return (at - slip_) % stick_block_ == 0;
  }

 private:
  std::size_t first_;
  std::size_t end_;
  std::size_t slip_;
  std::size_t slip_block_ = 1;
  std::size_t stick_block_ = 1;
};

}  // namespace

JunctionScans::JunctionScans() { points_.reserve(kMostPoints + 2); }

void JunctionScans::read(const estimate::Trace& trace, std::size_t first, std::size_t end,
                         const model::SharedParameters& shared) {
  points_.clear();
  scan_count_ = 0;
  const auto& [omega, gamma, r] = shared;
  const double start_s = trace.time_s[first];
  const double step_s =
      (trace.time_s[end - 1] - start_s) / static_cast<double>(std::max<std::size_t>(end - first, 2) - 1);
  const Blocks blocks{first, end, kSlipPeriods * 2.0 * std::numbers::pi / omega / step_s};
  JunctionPoint point;
  double count = 0.0;
  for (std::size_t k = first; k < end; ++k) {
    if (trace.usable[k] != 0) {
      ++scan_count_;
      count += 1.0;
      point.tau_s += (trace.time_s[k] - start_s - point.tau_s) / count;
      point.value += (trace.level(k) - point.value) / count;
    }
    if (count == 0.0 || !blocks.last(k)) continue;
    point.root_count = std::sqrt(count);
    points_.push_back(point);
    point = {};
    count = 0.0;
  }
  if (points_.empty()) return;
  const double last_s = points_.back().tau_s;
  lowest_ = highest_ = points_.front().value;
  for (JunctionPoint& at : points_) {
    lowest_ = std::min(lowest_, at.value);
    highest_ = std::max(highest_, at.value);
    const double decay = std::exp(-0.5 * gamma * at.tau_s);
    at.cosine = decay * std::cos(omega * at.tau_s);
    at.sine = decay * std::sin(omega * at.tau_s);
    const double to_end_s = at.tau_s - last_s;
    const double growth = std::exp(-0.5 * gamma * to_end_s);
    at.cosine_to_end = growth * std::cos(omega * to_end_s);
    at.sine_to_end = growth * std::sin(omega * to_end_s);
  }
}

}  // namespace stickslip::detect
