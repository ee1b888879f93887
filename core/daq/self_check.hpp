/// \file
/// What the unloaded tester said of itself just before a test.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/scan_index.hpp"

namespace stickslip::daq {

/// Of consecutive scans in which nothing pulled, right before the first scan of the record. Forces are those
/// of the load cell with its calibration; what too few scans cannot tell is absent.
struct SelfCheck {
  base::ScanIndex first_scan = 0;
  std::vector<double> raw;  ///< The scans themselves, as in the record: all below follows from them.
  std::optional<double> zero_N;
  std::optional<double> zero_standard_error_N;
  std::optional<double> drift_N_per_s;
  std::optional<double> drift_standard_error_N_per_s;
  std::optional<double> noise_N;         ///< Standard deviation of one scan.
  std::optional<double> hum_at_50_Hz_N;  ///< Amplitude.
  std::optional<double> hum_at_60_Hz_N;  ///< Amplitude.
  std::optional<double> hum_standard_error_N;
  std::optional<std::int64_t> spike_count;
  std::optional<std::int64_t> saturated_count;
  /// Of all scans since the acquisition began, by the computer's clock; a fact of then, not of `raw`.
  std::optional<double> scan_rate_Hz;
  std::optional<double> scan_rate_standard_error_Hz;
  std::vector<std::string> findings;  ///< What somebody should look at; empty: nothing.

  bool operator==(const SelfCheck&) const = default;
};

}  // namespace stickslip::daq
