#include "core/pipeline/test_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/pipeline/gain_uncertainty.hpp"
#include "core/pipeline/plausibility.hpp"
#include "core/pipeline/self_check.hpp"
#include "core/pipeline/true_rate.hpp"
#include "core/pipeline/zero_offset.hpp"

namespace stickslip::pipeline {
namespace {

using base::FindingCode;

void add_self_check(const TestFacts& facts, analysis::TestResults& results) {
  const daq::SelfCheck* const check = facts.self_check;
  if (facts.was_cut_out && (check == nullptr || !check->noise_N)) {
    const std::size_t count = check == nullptr ? 0 : check->raw.size();
    base::add(results.findings,
              base::make_finding(FindingCode::kNoSelfCheck,
                                 fmt::format("no self-check was possible: {} unloaded scans before the test, "
                                             "{} and {:g} s are needed",
                                             count, kFewestIdleScans, kShortestIdle_s),
                                 {{"unloaded_scan_count", static_cast<double>(count), "1"}}));
  }
  if (check == nullptr) return;
  // The zero is one finding: zero-offset has the worse of before and after.
  const bool zero_is_told =
      std::any_of(results.findings.begin(), results.findings.end(), [](const base::Finding& finding) {
        return finding.code == base::kind_of(FindingCode::kZeroOffset).name;
      });
  for (base::Finding& finding : self_check_findings(*check, facts.normal_load_N, facts.scan_rate_Hz)) {
    if (zero_is_told && finding.code == base::kind_of(FindingCode::kSelfCheckZero).name) continue;
    base::add(results.findings, std::move(finding));
  }
}

void add_saturation(const TestFacts& facts, analysis::TestResults& results) {
  if (facts.saturated_count == 0) return;
  base::add(results.findings,
            base::make_finding(FindingCode::kSaturated,
                               fmt::format("the converter was at a rail in {} of {} scans",
                                           facts.saturated_count, facts.scan_count),
                               {{"saturated_count", static_cast<double>(facts.saturated_count), "1"},
                                {"scan_count", static_cast<double>(facts.scan_count), "1"}}));
}

void add_calibration(const TestFacts& facts, analysis::TestResults& results) {
  if (facts.calibration.gain_change)
    base::add(results.findings, daq::finding(*facts.calibration.gain_change));
  const auto expires_ns = facts.calibration.expires_ns;
  if (expires_ns && facts.start_realtime_ns && *facts.start_realtime_ns >= *expires_ns)
    base::add(results.findings, expired_finding(facts.calibration.expires));
}

}  // namespace

base::Finding expired_finding(std::string_view expires) {
  return base::make_finding(FindingCode::kCalibrationExpired,
                            fmt::format("the calibration of the load cell expired on {}", expires));
}

void add_facts(const TestFacts& facts, analysis::TestResults& results) {
  add_true_rate(results, facts.anchors, facts.gaps, facts.scan_rate_Hz);
  add_gain_uncertainty(results, facts.calibration.gain_uncertainty);
  add_zero_offset(results, facts.level_before, facts.level_after);
  add_plausibility(results, facts.sled_mass_kg);
  add_calibration(facts, results);
  add_saturation(facts, results);
  add_self_check(facts, results);
}

}  // namespace stickslip::pipeline
