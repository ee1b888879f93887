/// \file
/// The report as one HTML file that needs nothing else: no network, no other file.
#pragma once

#include <string>

#include "report/chart_library.hpp"
#include "report/test_report.hpp"
#include <nlohmann/json_fwd.hpp>

namespace stickslip::report {

/// Materials read with traces. The tables show the numbers of report_json(). \param charts  stand in the
/// page.
[[nodiscard]] std::string report_page(const Material& material, const ChartLibrary& charts);
[[nodiscard]] std::string comparison_page(const Material& a, const Material& b,
                                          const MaterialComparison& comparison, const ChartLibrary& charts);

/// JSON that may stand inside a script element: no text in it can end the element.
[[nodiscard]] std::string json_for_script(const nlohmann::ordered_json& json);

}  // namespace stickslip::report
