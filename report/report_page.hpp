/// \file
/// The report as a self-contained HTML file: it needs no network and no other file.
#pragma once

#include <string>

#include "report/chart_library.hpp"
#include "report/test_report.hpp"
#include <nlohmann/json_fwd.hpp>

namespace stickslip::report {

/// Makes the page. Materials must have been read with traces. The tables show the numbers of report_json().
/// \param charts  is embedded in the page.
[[nodiscard]] std::string report_page(const Material& material, const ChartLibrary& charts);
[[nodiscard]] std::string comparison_page(const Material& a, const Material& b,
                                          const MaterialComparison& comparison, const ChartLibrary& charts);

/// JSON for a script element of HTML, escaped so that no text in it ends the element.
[[nodiscard]] std::string json_for_script(const nlohmann::ordered_json& json);

}  // namespace stickslip::report
