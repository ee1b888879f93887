/// \file
/// Import of a measured trace from a CSV file as a record.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.hpp"
#include "core/daq/board.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// Request for an import: the file and the facts that it does not contain.
struct CsvImportRequest {
  std::filesystem::path path;
  std::string column;                                          ///< Header of the column with the values.
  double rate_Hz = 0.0;                                        ///< Scans per second, positive and finite.
  daq::RawQuantity quantity = daq::RawQuantity::kCoefficient;  ///< Not kCounts.
  /// Header of the column with the time in s; empty: `t`, `t_s`, `time` or `time_s` if there is one.
  std::string time_column;
  TesterFacts tester;                      ///< Positive and finite where present.
  std::optional<daq::LoadCell> load_cell;  ///< For volts.
  ProcessFacts process;
};

/// Reads strictly [RFC 4180 with a header line, lines that begin with # before it left out]: every row as
/// long as the header, every value a finite number, every step of the time column 1/rate within the rounding
/// of its printed digits.
/// \return the record, with an end that has no results (reason "not analysed") and scan 0 first. Errors:
/// kUsage naming file:line, value and remedy; kFailure if the file cannot be read.
[[nodiscard]] base::Result<Record> read_csv(const CsvImportRequest& request);

}  // namespace stickslip::record
