/// \file
/// The history of a load cell's calibrations: one dated file each, beside each other in a folder, never
/// changed afterwards. `stickslip calibrate` writes them, the daemon takes the latest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "core/record/record.hpp"

namespace stickslip::io {

/// What goes with the numbers.
struct CalibrationPaper {
  std::string certificate;    ///< Of the weights.
  double valid_days = 365.0;  ///< 0: for ever.
};
inline constexpr double kLongestValid_days = 36'500.0;

/// A load cell with where its numbers come from.
struct StoredCalibration {
  daq::LoadCell load_cell;
  record::CalibrationFacts facts;
};

/// \param result  with a load cell (contract). \param date,expires  ISO 8601.
[[nodiscard]] StoredCalibration stored_calibration(const daq::WeighedCalibration& result, std::string date,
                                                   std::string expires, std::string certificate);

/// TOML with a comment on each key; numbers with all their digits.
[[nodiscard]] std::string calibration_text(const StoredCalibration& calibration);
/// \param name  stands for the file in messages. Errors: kUsage with line.
[[nodiscard]] base::Result<StoredCalibration> parse_calibration(std::string_view text, std::string_view name);

/// The file, or the latest (by its date) of the *.toml files of a folder. Errors: kUsage.
[[nodiscard]] base::Result<StoredCalibration> load_calibration(const std::filesystem::path& path);

/// The folder is there and a calibration in it.
[[nodiscard]] bool holds_calibration(const std::filesystem::path& folder);

/// FOLDER/20261122T101500Z.toml; the folder is made if absent. Never over another one: kUsage.
[[nodiscard]] base::Result<std::filesystem::path> keep_calibration(const std::filesystem::path& folder,
                                                                   const StoredCalibration& calibration);

struct KeptCalibration {
  StoredCalibration stored;
  std::filesystem::path file;
  std::optional<StoredCalibration> before;  ///< The latest of the folder until now.
};

/// What was weighed, with its papers, as the newest of a folder. \param result  with a load cell (contract).
/// \param now_ns  its date, since 1970. Errors: as load_calibration() and keep_calibration().
[[nodiscard]] base::Result<KeptCalibration> keep_result(const daq::WeighedCalibration& result,
                                                        const CalibrationPaper& paper,
                                                        const std::filesystem::path& folder,
                                                        std::int64_t now_ns);

/// Whether it is over at that time. \param now  ISO 8601 as record::iso_time().
[[nodiscard]] bool expired(const record::CalibrationFacts& facts, std::string_view now);

}  // namespace stickslip::io
