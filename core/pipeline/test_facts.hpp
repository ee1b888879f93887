/// \file
/// What is known of a test beside its scans, and what that adds to its results: uncertainties and findings.
/// The processor and the analysis of a record both end here, so that they agree to the last bit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/analysis/results.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/clock_anchor.hpp"
#include "core/daq/gain_change.hpp"
#include "core/daq/gap.hpp"
#include "core/daq/self_check_values.hpp"

namespace stickslip::pipeline {

/// Facts of the load cell's calibration in use.
struct CalibrationInUse {
  std::optional<double> gain_uncertainty = {};      ///< Standard error over gain; nullopt: unknown.
  std::optional<daq::GainChange> gain_change = {};  ///< A change that had to be confirmed.
  std::string expires = {};                         ///< ISO 8601; empty: never.
  std::optional<std::int64_t> expires_ns = {};  ///< Expired from then on, ns since 1970 UTC; nullopt: never.
};

/// The finding for a calibration that has expired. \param expires  date, ISO 8601.
[[nodiscard]] base::Finding expired_finding(std::string_view expires);

/// What is known of a test beside its scans. Anchors, gaps and self-check must outlive it.
struct TestFacts {
  double scan_rate_Hz = 0.0;  ///< Granted.
  std::span<const daq::ClockAnchor> anchors = {};
  std::span<const daq::Gap> gaps = {};
  /// Nullopt: unknown; no calibration then counts as expired.
  std::optional<std::int64_t> start_realtime_ns = {};
  CalibrationInUse calibration = {};
  double sled_mass_kg = 0.0;
  double normal_load_N = 0.0;
  /// The test was cut out of a longer sequence of scans, so that there should be unloaded scans before it. If
  /// they were too few for a self-check, a finding says so.
  bool was_cut_out = false;
  const daq::SelfCheck* self_check = nullptr;  ///< Null: there were no unloaded scans.
  /// Coefficient read by the unloaded cell before and after the test; nullopt if unknown.
  std::optional<double> level_before = {};
  std::optional<double> level_after = {};
  std::int64_t scan_count = 0;
  std::int64_t saturated_count = 0;
};

/// Adds scan_rate_measured, systematic uncertainties and findings to the results of the analysis.
void add_facts(const TestFacts& facts, analysis::TestResults& results);

}  // namespace stickslip::pipeline
