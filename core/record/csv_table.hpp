/// \file
/// Strict reader of two columns of numbers from a CSV file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::record {

/// One column with the resolution of its printed digits.
struct CsvColumn {
  std::string name;
  std::vector<double> values;
  int decimals = 0;            ///< Most digits behind the point of any value.
  int significant_digits = 0;  ///< Most significant digits of any value.

  /// Distance of neighbouring printable numbers near `value`, whether the writer fixed the number of
  /// decimals or of significant digits.
  [[nodiscard]] double resolution(double value) const;
};

struct CsvTable {
  CsvColumn values;
  CsvColumn time;                  ///< Empty name if there is none.
  std::vector<std::int64_t> line;  ///< Of each row, from 1.
};

/// \param column  must exist.
/// \param time_columns  names of a time column; the first one present is read, if any.
/// Errors: kUsage naming file:line, value and remedy; kFailure if the file cannot be read.
[[nodiscard]] base::Result<CsvTable> read_csv_table(const std::filesystem::path& path,
                                                    const std::string& column,
                                                    const std::vector<std::string>& time_columns);

}  // namespace stickslip::record
