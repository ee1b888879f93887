/// \file
/// uPlot, the JavaScript library that draws the charts of the pages. Its files are installed in
/// share/stickslip/pages.
#pragma once

#include <filesystem>
#include <string>

#include "core/base/result.hpp"

namespace stickslip::report {

struct ChartLibrary {
  std::string script;
  std::string style;
  std::string license;
};

/// The folder ../share/stickslip/pages, seen from the program's folder; in a package
/// /usr/share/stickslip/pages.
[[nodiscard]] std::filesystem::path chart_folder();

/// Reads the files. Errors: kFailure if one cannot be read; the message says how to make them.
[[nodiscard]] base::Result<ChartLibrary> read_chart_library(
    const std::filesystem::path& folder = chart_folder());

}  // namespace stickslip::report
