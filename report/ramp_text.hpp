/// \file
/// Summary of a ramp test in one line: S − K from the single slips, then the escape speed, as observed and as
/// corrected.
#pragma once

#include <string>

#include "core/analysis/results.hpp"

namespace stickslip::report {

/// "S−K 0.0501 ± 0.0003, scatter 0.0049, slip by slip; escaped at 6.43 mm/s, the first of many: 7.6 ± 0.5
/// mm/s for the mean of S−K". Empty if the pull speed is not known to change, or the model does not fit.
[[nodiscard]] std::string ramp_text(const analysis::TestResults& results);

}  // namespace stickslip::report
