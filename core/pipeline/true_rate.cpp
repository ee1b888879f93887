#include "core/pipeline/true_rate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/daq/rate_fit.hpp"

namespace stickslip::pipeline {
namespace {

/// Relative error of the computer's quartz: lower limit of the rate's uncertainty, and of a deviation that is
/// reported.
constexpr double kClockTolerance = 100e-6;
/// Standard errors that a reported deviation must exceed.
constexpr double kSureErrors = 5.0;

}  // namespace

void add_true_rate(analysis::TestResults& results, std::span<const daq::ClockAnchor> anchors,
                   std::span<const daq::Gap> gaps, double granted_Hz) {
  if (anchors.empty()) return;
  const auto fit = daq::fit_rate(anchors, gaps, granted_Hz);
  if (!fit) {
    const bool few = anchors.size() < static_cast<std::size_t>(daq::RateFit::kFewestAnchors);
    results.scan_rate_measured = analysis::Estimate::none(
        fmt::format("{} clock readings; at least {} {}are needed", anchors.size(),
                    daq::RateFit::kFewestAnchors, few ? "" : "that were not read late "));
    return;
  }
  results.scan_rate_measured = analysis::Estimate::of(fit->rate_Hz, fit->standard_error_Hz);
  add_systematic(results.scan_rate_measured, analysis::UncertaintySource::kClock,
                 kClockTolerance * fit->rate_Hz);
  const double factor = fit->rate_Hz / granted_Hz;
  const bool far = std::abs(factor - 1.0) > kClockTolerance &&
                   std::abs(fit->rate_Hz - granted_Hz) > kSureErrors * fit->standard_error_Hz;
  if (far) {
    base::add(
        results.findings,
        base::make_finding(
            base::FindingCode::kScanRate,
            fmt::format(
                "scan rate: {:.7g} +- {:.2g} Hz by the clock, {:.7g} Hz granted by the board ({:+.0f} ppm); "
                "the true omega, frequencies and speeds are {:.6f} times those given, times are divided by "
                "it",
                fit->rate_Hz, fit->standard_error_Hz, granted_Hz, 1e6 * (factor - 1.0), factor),
            {{"scan_rate", fit->rate_Hz, "Hz"},
             {"standard_error", fit->standard_error_Hz, "Hz"},
             {"scan_rate_granted", granted_Hz, "Hz"},
             {"factor", factor, "1"}}));
  }
}

}  // namespace stickslip::pipeline
