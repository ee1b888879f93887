/// \file
/// Calibration files of a load cell. A folder holds one TOML file for each calibration, named by its date and
/// never changed. `stickslip calibrate` and the daemon write them; the daemon uses the latest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/result.hpp"
#include "core/daq/gain_change.hpp"
#include "core/daq/weighed_calibration.hpp"
#include "core/record/record.hpp"

namespace stickslip::io {

/// What the user states about a calibration, beside the readings.
struct CalibrationPaper {
  std::string certificate;     ///< Of the weights, as free text; may be empty.
  double valid_days = 365.0;   ///< From its date until it expires; 0: it never does.
  bool confirms_gain = false;  ///< A daq::GainChange is meant.
};
/// Largest CalibrationPaper::valid_days that is accepted.
inline constexpr double kLongestValid_days = 36'500.0;

/// A load cell and the origin of its numbers.
struct StoredCalibration {
  daq::LoadCell load_cell;
  record::CalibrationFacts facts;
};

/// Joins a fit with its date and its papers. \param result  must have a load cell (contract).
/// \param date,expires  ISO 8601, UTC; an empty `expires`: never.
[[nodiscard]] StoredCalibration stored_calibration(const daq::WeighedCalibration& result, std::string date,
                                                   std::string expires, std::string certificate);

/// The calibration as TOML, with a comment on each key. Numbers have all their digits.
[[nodiscard]] std::string calibration_text(const StoredCalibration& calibration);
/// Reads what calibration_text() wrote. \param name  stands for the file in messages. Errors: kUsage, with
/// the line.
[[nodiscard]] base::Result<StoredCalibration> parse_calibration(std::string_view text, std::string_view name);

/// Reads a calibration file or, if `path` is a folder, all its *.toml files; returns the one with the latest
/// date. Errors: kUsage.
[[nodiscard]] base::Result<StoredCalibration> load_calibration(const std::filesystem::path& path);

/// True if the folder exists and holds a *.toml file.
[[nodiscard]] bool holds_calibration(const std::filesystem::path& folder);

/// Writes the calibration to a new file, FOLDER/20261122T101500Z.toml by its date, and returns the path.
/// Makes the folder if it is absent. Errors: kUsage if the file exists, kFailure if it cannot be written.
[[nodiscard]] base::Result<std::filesystem::path> keep_calibration(const std::filesystem::path& folder,
                                                                   const StoredCalibration& calibration);

struct KeptCalibration {
  StoredCalibration stored;
  std::filesystem::path file;
  std::optional<StoredCalibration> before;  ///< The folder's latest one before it, if any.
};

/// Stores a new calibration, dated `now_ns`, in a folder. \param result  must have a load cell (contract).
/// \param now_ns  nanoseconds since 1970, UTC. \param confirmed  a change of the gain that was confirmed; the
/// file says so. Errors: as load_calibration() and keep_calibration().
[[nodiscard]] base::Result<KeptCalibration> keep_result(const daq::WeighedCalibration& result,
                                                        const CalibrationPaper& paper,
                                                        const std::filesystem::path& folder,
                                                        std::int64_t now_ns,
                                                        const std::optional<daq::GainChange>& confirmed);

/// True if the calibration has expired at `now`. \param now  ISO 8601, as record::iso_time() writes it.
[[nodiscard]] bool expired(const record::CalibrationFacts& facts, std::string_view now);

}  // namespace stickslip::io
