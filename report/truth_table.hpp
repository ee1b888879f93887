/// \file
/// The table of tests for people: below each measured number its errors and the truth, if known.
///
///      test  regime         S−K       S       K  static  kinetic  file, scene
///         1  stick-slip  0.04985  0.3499  0.3001  0.3822   0.3020  FILE
///            ± stat.     0.00035  0.0004  0.0001
///            ± syst.     0.00021  0.0020  0.0030  0.0030   0.0030
///     truth  stick-slip  0.0500   0.3500  0.3000  0.3813   0.3019  SCENE
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/analysis/results.hpp"
#include "core/model/truth.hpp"

namespace stickslip::report {

struct TableRow {
  std::int64_t number = 0;
  analysis::TestResults results;
  std::optional<model::TestTruth> truth;
  std::string where;  ///< File, or why there is none.
};

/// The whole table in UTF-8, at most 80 columns wide, one to four lines per row; then, files and scenes if
/// they do not fit behind the numbers, what the rows of errors mean, which numbers are not significant ("?"),
/// why numbers are absent ("–"), and the findings ("!").
[[nodiscard]] std::string format_table(std::span<const TableRow> rows);

}  // namespace stickslip::report
