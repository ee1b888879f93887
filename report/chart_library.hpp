/// \file
/// uPlot, which draws the charts of the pages: files beside the programs, in share/stickslip/pages.
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

/// share/stickslip/pages beside the folder of this program: /usr/share/stickslip/pages of a package.
[[nodiscard]] std::filesystem::path chart_folder();

/// kFailure: a file cannot be read; says how the files are made.
[[nodiscard]] base::Result<ChartLibrary> read_chart_library(
    const std::filesystem::path& folder = chart_folder());

}  // namespace stickslip::report
