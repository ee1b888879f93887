/// \file
/// Reports for people at a terminal: Fig. 1 of [Penner 1995] as a table, then the replicates of each speed,
/// or the comparison of two materials.
#pragma once

#include <string>

#include "report/test_report.hpp"

namespace stickslip::report {

/// In UTF-8, whole lines.
[[nodiscard]] std::string report_text(const Material& material);
[[nodiscard]] std::string comparison_text(const Material& a, const Material& b,
                                          const MaterialComparison& comparison);

}  // namespace stickslip::report
