/// \file
/// The table of tests for people: each measured number with the truth below it, if known.
///
///     test            regime      static  kinetic        S        K      S-K      Hz …
///        1  measured  stick-slip  0.3824   0.3012   0.3500   0.3000   0.0500  19.314 …  FILE
///           truth     stick-slip       –        –   0.3500   0.3000   0.0500  19.314 …  SCENE
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

/// The whole table in UTF-8, one or two lines per row; then, why numbers are absent ("–").
[[nodiscard]] std::string format_table(std::span<const TableRow> rows);

}  // namespace stickslip::report
