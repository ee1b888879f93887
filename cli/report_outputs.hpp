/// \file
/// Where `stickslip report` and `stickslip compare` put what they found: files, or the standard output.
#pragma once

#include <functional>
#include <string>

#include "report/test_report.hpp"
#include <CLI/CLI.hpp>

#include "core/base/result.hpp"

namespace stickslip::cli {

struct ReportOutputs {
  std::string csv;   ///< File to make; empty: none; "-": the standard output, instead of the text.
  std::string page;  ///< HTML file to make; likewise.
  bool json = false;
};

/// What they need of the records.
[[nodiscard]] report::Detail detail_of(const ReportOutputs& outputs) noexcept;

void add_report_outputs(CLI::App& command, ReportOutputs& outputs);

/// Before the work, not only after it. Usage error: a file exists, or two of them have one place.
[[nodiscard]] base::Result<void> check_outputs(const ReportOutputs& outputs);

/// Makes the forms of a report; called for those that are asked for alone.
struct ReportForms {
  std::function<std::string()> csv;
  std::function<std::string()> page;
  std::function<std::string()> json;
  std::function<std::string()> text;
};

/// Makes the files first, so that nothing is printed before all has succeeded. \return what to print.
[[nodiscard]] base::Result<std::string> deliver(const ReportOutputs& outputs, const ReportForms& forms);

}  // namespace stickslip::cli
