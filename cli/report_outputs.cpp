#include "cli/report_outputs.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "io/new_file.hpp"

#include "core/record/finaliser.hpp"

namespace stickslip::cli {
namespace {

/// Instead of a file to be made.
constexpr const char* kStandardOutput = "-";

}  // namespace

report::Detail detail_of(const ReportOutputs& outputs) noexcept {
  if (!outputs.page.empty()) return report::Detail::kTraces;
  return outputs.json || !outputs.csv.empty() ? report::Detail::kResults : report::Detail::kTables;
}

void add_report_outputs(CLI::App& command, ReportOutputs& outputs) {
  command
      .add_option("-o,--output", outputs.page,
                  "page to make, one file with traces to zoom in; must not exist; \"-\": standard output")
      ->type_name("FILE.html");
  command.add_option("--csv", outputs.csv, "table to make; must not exist; \"-\": standard output")
      ->type_name("FILE.csv");
  command.add_flag("--json", outputs.json, "JSON instead of tables; SI units, null where there is no number");
}

base::Result<void> check_outputs(const ReportOutputs& outputs) {
  const std::array taken{outputs.csv == kStandardOutput, outputs.page == kStandardOutput, outputs.json};
  if (std::count(taken.begin(), taken.end(), true) > 1)
    return base::usage_error("-o -, --csv - and --json: one of them has the standard output to itself");
  for (const std::string& file : {outputs.csv, outputs.page}) {
    if (file.empty() || file == kStandardOutput) continue;
    if (auto free = record::check_publishable(file); !free) return free;
  }
  if (!outputs.csv.empty() && outputs.csv == outputs.page) {
    return base::usage_error("--csv and -o name the same file, {}", outputs.csv);
  }
  return {};
}

base::Result<std::string> deliver(const ReportOutputs& outputs, const ReportForms& forms) {
  std::string printed;
  bool text = !outputs.json;
  for (const auto& [file, form] : {std::pair{&outputs.csv, &forms.csv}, {&outputs.page, &forms.page}}) {
    if (file->empty()) continue;
    if (*file == kStandardOutput) {
      printed = (*form)();
      text = false;
    } else if (auto written = io::write_new_file(*file, (*form)()); !written) {
      return tl::unexpected(written.error());
    }
  }
  if (outputs.json) return forms.json();
  return text ? forms.text() : printed;
}

}  // namespace stickslip::cli
