/// \file
/// A record as a picture: the force over time, what the detector found in it, and the truth where it is
/// known.
#pragma once

#include <optional>
#include <string>

#include "report/plot/figure.hpp"

#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::report {

/// Which part of it, and what with it. Times are in s after the first scan.
struct RecordView {
  std::string title{};             ///< Else the record's.
  std::optional<double> from_s{};  ///< Else the start.
  std::optional<double> to_s{};    ///< Else the end.
  bool overview = false;           ///< Above it the whole record, with the part marked.
  bool derivative = false;  ///< Below it the speed at which the coupling stretches [Penner 1995, Fig. 4].
};

/// The force as a coefficient. Shaded: modes (stick, slip, slack) of the truth. Dashed: S and K of each slip
/// in the truth. Points: peaks that the detector found. Errors: kUsage if the part is not in the record, or
/// the record has counts without a load cell.
[[nodiscard]] base::Result<plot::Figure> record_figure(const record::Record& record, const RecordView& view);

}  // namespace stickslip::report
