#include "core/pipeline/self_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "core/analysis/hum_check.hpp"
#include "core/signal/despike.hpp"
#include "core/signal/noise.hpp"

namespace stickslip::pipeline {
namespace {

// Limits beyond which the user is warned. Forces are given as coefficients (force over the sled's weight).

/// A tenth of the smallest S − K of Penner's Table 1 (0.025): a bias of every coefficient of that size shows.
constexpr double kLargestZero = 0.0025;
/// Drift by kLargestZero in a minute.
constexpr double kLargestDrift_per_s = kLargestZero / 60.0;
/// A tenth of the amplitude for S − K = 0.05; larger noise creates turning points of its own.
constexpr double kLargestNoise = 0.005;
/// Rate of spikes at which the detector is tested (docs/detector-limits.md).
constexpr double kMostSpikes_per_s = 20.0;
/// Ten times the error of an aged quartz.
constexpr double kLargestRateError = 1e-3;
/// Standard errors by which a limit must be exceeded; chance alone does so once in a thousand.
constexpr double kSignificant = 3.3;

constexpr int kParameters = 6;

/// Spikes replaced as for the detector, and how many.
std::int64_t despike(std::vector<double>& values, double floor) {
  const double sigma = signal::scan_noise(values, floor);
  signal::Despiker despiker;
  std::int64_t spikes = 0;
  std::size_t out = 0;
  const auto take = [&](const signal::DespikedScan& scan) {
    values[out++] = scan.value;
    if (scan.spike) ++spikes;
  };
  for (const double value : std::vector<double>{values}) {
    if (const auto scan = despiker.add(value, sigma)) take(*scan);
  }
  while (const auto scan = despiker.flush(sigma)) take(*scan);
  return spikes;
}

struct IdleFit {
  double zero = 0.0;
  double zero_error = 0.0;
  double drift_per_s = 0.0;
  double drift_error_per_s = 0.0;
  double noise = 0.0;
  double hum[2] = {0.0, 0.0};
  double hum_error = 0.0;
};

/// \param with_hum  else only the line.
IdleFit fit_idle(const std::vector<double>& values, double scan_rate_Hz, bool with_hum) {
  const auto n = static_cast<Eigen::Index>(values.size());
  const Eigen::Index parameters = with_hum ? kParameters : 2;
  Eigen::MatrixXd basis(n, parameters);
  const double middle = 0.5 * static_cast<double>(n - 1);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double time_s = (static_cast<double>(i) - middle) / scan_rate_Hz;
    basis(i, 0) = 1.0;
    basis(i, 1) = time_s;
    if (!with_hum) continue;
    for (Eigen::Index k = 0; k < 2; ++k) {
      const double phase = 2.0 * std::numbers::pi * analysis::kMains_Hz[k] * time_s;
      basis(i, 2 + 2 * k) = std::cos(phase);
      basis(i, 3 + 2 * k) = std::sin(phase);
    }
  }
  const Eigen::Map<const Eigen::VectorXd> y(values.data(), n);
  const Eigen::MatrixXd inverse = (basis.transpose() * basis).inverse();
  const Eigen::VectorXd solution = inverse * (basis.transpose() * y);
  const double variance = (y - basis * solution).squaredNorm() / static_cast<double>(n - parameters);
  IdleFit fit;
  fit.noise = std::sqrt(variance);
  fit.zero = solution(0);
  fit.zero_error = std::sqrt(variance * inverse(0, 0));
  fit.drift_per_s = solution(1);
  fit.drift_error_per_s = std::sqrt(variance * inverse(1, 1));
  if (!with_hum) return fit;
  for (Eigen::Index k = 0; k < 2; ++k) {
    fit.hum[k] = std::hypot(solution(2 + 2 * k), solution(3 + 2 * k));
    fit.hum_error = std::max({fit.hum_error, std::sqrt(variance * inverse(2 + 2 * k, 2 + 2 * k)),
                              std::sqrt(variance * inverse(3 + 2 * k, 3 + 2 * k))});
  }
  return fit;
}

}  // namespace

std::vector<base::Finding> self_check_findings(const daq::SelfCheck& check, double load_N,
                                               double scan_rate_Hz) {
  using base::FindingCode;
  std::vector<base::Finding> findings;
  const auto found = [&findings](FindingCode code, std::string text,
                                 std::vector<base::FindingNumber> numbers) {
    findings.push_back(base::make_finding(code, std::move(text), std::move(numbers)));
  };
  const auto above = [load_N](std::optional<double> force_N, double limit, std::optional<double> error_N) {
    return force_N && std::abs(*force_N) > limit * load_N &&
           std::abs(*force_N) > kSignificant * error_N.value_or(0.0);
  };
  const auto scans = static_cast<double>(check.raw.size());
  const double duration_s = scans / scan_rate_Hz;
  if (check.saturated_count.value_or(0) > 0) {
    found(
        FindingCode::kSelfCheckSaturated,
        fmt::format("the converter is at a rail with no load, {} of {} scans", *check.saturated_count,
                    check.raw.size()),
        {{"saturated_count", static_cast<double>(*check.saturated_count), "1"}, {"scan_count", scans, "1"}});
  }
  const auto spikes = static_cast<double>(check.spike_count.value_or(0));
  // Counted events scatter by their square root.
  if (spikes - kSignificant * std::sqrt(spikes) > kMostSpikes_per_s * duration_s) {
    found(FindingCode::kSelfCheckSpikes,
          fmt::format("{} spikes in {:.2g} s: look for a loose contact", *check.spike_count, duration_s),
          {{"spike_count", spikes, "1"}, {"duration", duration_s, "s"}, {"limit", kMostSpikes_per_s, "1/s"}});
  }
  if (above(check.zero_N, kLargestZero, check.zero_standard_error_N)) {
    found(FindingCode::kSelfCheckZero,
          fmt::format("the unloaded cell reads {:.3g} N: calibrate, or set load_cell_zero", *check.zero_N),
          {{"zero", *check.zero_N, "N"}, {"limit", kLargestZero * load_N, "N"}});
  }
  if (above(check.drift_N_per_s, kLargestDrift_per_s, check.drift_standard_error_N_per_s)) {
    found(FindingCode::kSelfCheckDrift,
          fmt::format("the zero drifts by {:.2g} N in a minute: let the tester warm up",
                      60.0 * *check.drift_N_per_s),
          {{"drift", *check.drift_N_per_s, "N/s"}, {"limit", kLargestDrift_per_s * load_N, "N/s"}});
  }
  if (above(check.noise_N, kLargestNoise, {})) {
    found(FindingCode::kSelfCheckNoise, fmt::format("noise of {:.2g} N a scan", *check.noise_N),
          {{"noise", *check.noise_N, "N"}, {"limit", kLargestNoise * load_N, "N"}});
  }
  const std::pair<double, std::optional<double>> hums[] = {{analysis::kMains_Hz[0], check.hum_at_50_Hz_N},
                                                           {analysis::kMains_Hz[1], check.hum_at_60_Hz_N}};
  for (const auto& [frequency_Hz, hum_N] : hums) {
    if (above(hum_N, analysis::kLargestHum, check.hum_standard_error_N)) {
      found(
          FindingCode::kSelfCheckHum,
          fmt::format(
              "hum of {:.2g} N at {} Hz: static, S and K of each slip are off by up to {:.2g}, a fall of up "
              "to {:.2g} may be hum, and no stick-slip smaller than that is told from sliding: look for a "
              "ground loop",
              *hum_N, frequency_Hz, *hum_N / load_N, 2.0 * *hum_N / load_N),
          {{"hum", *hum_N, "N"},
           {"frequency", frequency_Hz, "Hz"},
           {"limit", analysis::kLargestHum * load_N, "N"},
           {"coefficient_error", *hum_N / load_N, "1"}});
    }
  }
  if (check.scan_rate_Hz) {
    const double error_Hz = std::abs(*check.scan_rate_Hz - scan_rate_Hz);
    if (error_Hz > kLargestRateError * scan_rate_Hz &&
        error_Hz > kSignificant * check.scan_rate_standard_error_Hz.value_or(0.0)) {
      found(FindingCode::kSelfCheckRate,
            fmt::format("the board scans at {:.6g} Hz by the computer's clock, {:.6g} Hz was granted",
                        *check.scan_rate_Hz, scan_rate_Hz),
            {{"scan_rate", *check.scan_rate_Hz, "Hz"}, {"scan_rate_granted", scan_rate_Hz, "Hz"}});
    }
  }
  return findings;
}

daq::SelfCheck check_idle(base::ScanIndex first, std::span<const double> raw,
                          const daq::Calibration& calibration, double scan_rate_Hz,
                          const std::optional<daq::RateEstimate>& rate) {
  daq::SelfCheck check;
  check.first_scan = first;
  check.raw.assign(raw.begin(), raw.end());
  check.saturated_count =
      std::count_if(raw.begin(), raw.end(), [&](double value) { return calibration.saturated(value); });
  if (rate) {
    check.scan_rate_Hz = rate->rate_Hz;
    check.scan_rate_standard_error_Hz = rate->standard_error_Hz;
  }
  const double load_N = calibration.normal_load_N();
  if (raw.size() >= kFewestIdleScans && static_cast<double>(raw.size()) >= kShortestIdle_s * scan_rate_Hz) {
    std::vector<double> force_N(raw.size());
    std::transform(raw.begin(), raw.end(), force_N.begin(),
                   [&](double value) { return calibration.force_N(value); });
    const double step_N = calibration.step_coefficient() * load_N;
    check.spike_count = despike(force_N, step_N / std::sqrt(12.0));
    const bool with_hum = scan_rate_Hz >= analysis::kLowestRateForHum_Hz;
    const IdleFit fit = fit_idle(force_N, scan_rate_Hz, with_hum);
    check.zero_N = fit.zero;
    check.zero_standard_error_N = fit.zero_error;
    check.drift_N_per_s = fit.drift_per_s;
    check.drift_standard_error_N_per_s = fit.drift_error_per_s;
    check.noise_N = fit.noise;
    if (with_hum) {
      check.hum_at_50_Hz_N = fit.hum[0];
      check.hum_at_60_Hz_N = fit.hum[1];
      check.hum_standard_error_N = fit.hum_error;
    }
  }
  check.findings = base::texts_of(self_check_findings(check, load_N, scan_rate_Hz));
  return check;
}

IdleScans::IdleScans(double scan_rate_Hz) noexcept
    : scan_rate_Hz_(scan_rate_Hz),
      most_(static_cast<std::size_t>(
          std::clamp(kKept_s * scan_rate_Hz, 1.0, static_cast<double>(kMostScans)))) {}

void IdleScans::add(base::ScanIndex index, double raw) {
  if (index != end_) scans_.clear();
  end_ = index + 1;
  scans_.push_back(raw);
  if (scans_.size() > most_) scans_.pop_front();
}

std::optional<daq::SelfCheck> IdleScans::check(const daq::Calibration& calibration,
                                               const std::optional<daq::RateEstimate>& rate) const {
  if (scans_.empty()) return std::nullopt;
  const std::vector<double> raw(scans_.begin(), scans_.end());
  return check_idle(end_ - static_cast<base::ScanIndex>(raw.size()), raw, calibration, scan_rate_Hz_, rate);
}

}  // namespace stickslip::pipeline
