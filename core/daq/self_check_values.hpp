/// \file
/// Self-check of the unloaded tester just before a test.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/scan_index.hpp"

namespace stickslip::daq {

/// Results over consecutive unloaded scans, right before the first scan of the record. Forces are calibrated.
/// A result is absent if it is not known, for example with too few scans.
struct SelfCheck {
  base::ScanIndex first_scan = 0;
  std::vector<double> raw;       ///< Raw readings of these scans; the members below follow from them.
  std::optional<double> zero_N;  ///< Mean force, without spikes and hum.
  std::optional<double> zero_standard_error_N;
  std::optional<double> drift_N_per_s;
  std::optional<double> drift_standard_error_N_per_s;
  std::optional<double> noise_N;  ///< Standard deviation of one scan about drift and hum, if hum is known.
  std::optional<double> hum_at_50_Hz_N;  ///< Amplitude.
  std::optional<double> hum_at_60_Hz_N;  ///< Amplitude.
  std::optional<double> hum_standard_error_N;
  std::optional<std::int64_t> spike_count;
  std::optional<std::int64_t> saturated_count;
  /// Scan rate since the acquisition began, by the computer's clock; not computed from `raw`.
  std::optional<double> scan_rate_Hz;
  std::optional<double> scan_rate_standard_error_Hz;
  std::vector<std::string> findings;  ///< Sentences of its findings, as the record stores them.

  bool operator==(const SelfCheck&) const = default;
};

}  // namespace stickslip::daq
