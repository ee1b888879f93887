/// \file
/// Figure of a record: the force over time, the findings of the detector, and the truth if known.
#pragma once

#include <optional>
#include <string>

#include "report/plot/figure.hpp"

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::report {

/// Part of the record to draw, and additional panels. Times are in s after the first scan.
struct RecordView {
  std::string title{};             ///< Empty: that of the record.
  std::optional<double> from_s{};  ///< Absent: from the start.
  std::optional<double> to_s{};    ///< Absent: to the end.
  bool overview = false;           ///< Adds a panel above with the whole record, the part marked.
  /// Adds a panel below with the speed at which the coupling stretches [Penner 1995, Fig. 4].
  bool derivative = false;
};

/// Draws the force as a coefficient. The true modes (stick, slip, slack) are shaded, the true S and K of each
/// slip dashed, the detected peaks marked by points. Errors: kUsage if the part is not in the record, or the
/// record has counts without a load cell.
[[nodiscard]] base::Result<plot::Figure> record_figure(const record::Record& record, const RecordView& view);

}  // namespace stickslip::report
