/// \file
/// Where `stickslip report` and `stickslip compare` put what they found: files, or the standard output.
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

struct ReportOutputs {
  std::string csv;   ///< File to make; empty: none; "-": the standard output, instead of the text.
  std::string page;  ///< HTML file to make; likewise.
  bool json = false;
};

void add_report_outputs(CLI::App& command, ReportOutputs& outputs);

/// Before the work, not only after it. Usage error: a file exists, or two of them have one place.
[[nodiscard]] base::Result<void> check_outputs(const ReportOutputs& outputs);

/// Makes the files first, so that nothing is printed before all has succeeded. \return what to print.
[[nodiscard]] base::Result<std::string> deliver(const ReportOutputs& outputs, const std::string& csv,
                                                const std::string& page, const nlohmann::ordered_json& json,
                                                const std::string& text);

}  // namespace stickslip::cli
