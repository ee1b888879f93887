#include "core/accuracy/grazing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/contract.hpp"
#include "core/model/slip_waveform.hpp"
#include "core/model/threshold.hpp"

namespace stickslip::accuracy {
namespace {

constexpr double kOmega = 2.0 * std::numbers::pi * 20.0;  ///< [Penner 1995, Experimental]
constexpr double kGravity_m_per_s2 = 9.80665;
constexpr double kDeltaMu = 0.05;  ///< [Table 1]
constexpr double kMuK = 0.30;      ///< [Table 1]
constexpr double kScanRate_Hz = 350.0;

double range_of(std::span<const double> c) {
  const auto [least, most] = std::minmax_element(c.begin(), c.end());
  return *most - *least;
}

Grazing grazing_of(GoesOn below, GoesOn above) {
  if (below == GoesOn::kUndecided || above == GoesOn::kUndecided) return Grazing::kUndecided;
  if (below == GoesOn::kYes) return above == GoesOn::kYes ? Grazing::kFalse : Grazing::kFound;
  return above == GoesOn::kYes ? Grazing::kReversed : Grazing::kMissed;
}

}  // namespace

std::string_view name(Grazing grazing) noexcept {
  switch (grazing) {
    case Grazing::kFound:
      return "found";
    case Grazing::kMissed:
      return "missed";
    case Grazing::kFalse:
      return "false";
    case Grazing::kReversed:
      return "reversed";
    case Grazing::kUndecided:
      return "undecided";
  }
  return {};
}

sim::Motion grazing_motion(double gamma_over_2omega, double Q) {
  sim::Motion motion;
  motion.oscillator = model::Oscillator::from_omega(kOmega, gamma_over_2omega);
  // A belt that starts at once takes the sled along if friction accelerates it to c′ = r before the spring
  // stops it; K three times the overshoot r/ω is plenty.
  motion.mu_k = std::fmax(kMuK, 3.0 * Q * kDeltaMu);
  motion.mu_s = motion.mu_k + kDeltaMu;
  motion.gravity_m_per_s2 = kGravity_m_per_s2;
  const double rate = Q * kOmega * (motion.mu_s - motion.mu_k);
  motion.belt = {{1e9, rate * kGravity_m_per_s2 / motion.oscillator.omega0_squared(), false}};
  return motion;
}

GoesOn goes_on(const Method& method, double gamma_over_2omega, double Q) {
  STICKSLIP_EXPECTS(gamma_over_2omega > 0.0 && Q > 0.0);
  sim::Motion motion = grazing_motion(gamma_over_2omega, Q);
  STICKSLIP_EXPECTS(method.lacks(motion).empty());
  const double rate = motion.oscillator.stick_rate_per_s(motion.belt[0].speed_m_per_s, kGravity_m_per_s2);
  // A ring-down shrinks by e^(−πγ/ω) a cycle: to an eighth, but six cycles at least.
  const double cycles = std::fmax(6.0, std::log(8.0) / (2.0 * std::numbers::pi * gamma_over_2omega));
  const double period_s = 2.0 * std::numbers::pi / kOmega + 2.0 * kDeltaMu / rate;  // Of a cycle at the most.
  const auto scans = [](double time_s) { return static_cast<std::size_t>(std::ceil(time_s * kScanRate_Hz)); };
  const std::size_t last = scans(2.0 * period_s);
  const std::size_t to_first_slip = scans(motion.mu_s / rate);
  std::vector<double> coefficient(to_first_slip + scans(cycles * period_s) + last);
  // No longer than it is observed: a method with an accuracy over the whole course must not work for more.
  motion.belt[0].duration_s = static_cast<double>(coefficient.size()) / kScanRate_Hz;
  if (method.run(motion, kScanRate_Hz, 1, coefficient).undecided_count > 0) return GoesOn::kUndecided;
  const std::span<const double> all = coefficient;
  // The first slip is the same with capture and without up to its least force: [17].
  const model::SlipWaveform slip{motion.mu_k, motion.mu_s - motion.mu_k, rate, motion.oscillator};
  const double first_range = slip.value(slip.peak_time_s()) - slip.value(slip.trough_time_s());
  return range_of(all.last(last)) > 0.5 * first_range ? GoesOn::kYes : GoesOn::kNo;
}

std::vector<GrazingRow> grazing_table(double gamma_over_2omega,
                                      std::span<const std::unique_ptr<Method>> methods,
                                      const Progress& progress) {
  const double Q_th = model::Q_threshold(gamma_over_2omega);
  std::vector<GrazingRow> table;
  for (const std::unique_ptr<Method>& method : methods) {
    if (progress) progress(static_cast<double>(table.size()) / static_cast<double>(methods.size()));
    GrazingRow row{std::string{method->name()}, method->setting(), {}};
    for (int n = 1; n <= kFinestStep; ++n) {
      const double step = std::pow(10.0, -n);
      row.steps[static_cast<std::size_t>(n - 1)] =
          grazing_of(goes_on(*method, gamma_over_2omega, Q_th * (1.0 - step)),
                     goes_on(*method, gamma_over_2omega, Q_th * (1.0 + step)));
    }
    table.push_back(std::move(row));
  }
  if (progress) progress(1.0);
  return table;
}

double apparent_threshold(const Method& method, double gamma_over_2omega, double low, double high,
                          double width) {
  STICKSLIP_EXPECTS(width > 0.0);
  while (high - low > width) {
    const double middle = low + (high - low) / 2.0;
    (goes_on(method, gamma_over_2omega, middle) == GoesOn::kYes ? low : high) = middle;
  }
  return low + (high - low) / 2.0;
}

}  // namespace stickslip::accuracy
