#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "cli/commands.hpp"
#include "io/json_text.hpp"
#include "io/new_file.hpp"
#include "report/report_json.hpp"
#include "report/report_page.hpp"
#include "report/report_text.hpp"
#include "report/test_report.hpp"
#include <nlohmann/json.hpp>

#include "core/record/finaliser.hpp"

namespace stickslip::cli {
namespace {

using base::Result;
using Json = nlohmann::ordered_json;

/// Instead of a file to be made.
constexpr const char* kStandardOutput = "-";

/// Before the work, not only after it.
Result<void> check_outputs(const ReportOptions& options) {
  const std::array taken{options.csv == kStandardOutput, options.page == kStandardOutput, options.json};
  if (std::count(taken.begin(), taken.end(), true) > 1)
    return base::usage_error("-o -, --csv - and --json: one of them has the standard output to itself");
  for (const std::string& file : {options.csv, options.page}) {
    if (file.empty() || file == kStandardOutput) continue;
    if (auto free = record::check_publishable(file); !free) return free;
  }
  if (!options.csv.empty() && options.csv == options.page) {
    return base::usage_error("--csv and -o name the same file, {}", options.csv);
  }
  return {};
}

/// Files first, so that nothing is printed before all has succeeded.
Result<std::string> deliver(const ReportOptions& options, const std::string& csv, const std::string& page,
                            const Json& json, const std::string& text) {
  std::string printed = options.json ? io::json_document(json) : text;
  for (const auto& [file, made] : {std::pair{&options.csv, &csv}, {&options.page, &page}}) {
    if (file->empty()) continue;
    if (*file == kStandardOutput) {
      printed = *made;
    } else if (auto written = io::write_new_file(*file, *made); !written) {
      return tl::unexpected(written.error());
    }
  }
  return printed;
}

}  // namespace

Result<std::string> run_report(const ReportCommand& command) {
  if (auto free = check_outputs(command); !free) return tl::unexpected(free.error());
  if (!command.batch.empty() && command.files.size() != 1) {
    return base::usage_error("--batch {}: one folder of records is to be named, not {}", command.batch,
                             command.files.size());
  }
  const bool with_traces = !command.page.empty();
  const Result<report::ChartLibrary> charts =
      with_traces ? report::read_chart_library() : report::ChartLibrary{};
  if (!charts) return tl::unexpected(charts.error());
  const Result<report::Material> material =
      command.batch.empty() ? report::read_material("", command.files, with_traces)
                            : report::read_batch("", command.batch, command.files.front(), with_traces);
  if (!material) return tl::unexpected(material.error());
  return deliver(command, report::report_csv(*material),
                 with_traces ? report::report_page(*material, *charts) : "", report::report_json(*material),
                 report::report_text(*material));
}

Result<std::string> run_compare(const CompareCommand& command) {
  const bool batches = !command.batch_a.empty() || !command.batch_b.empty();
  if (batches &&
      (command.batch_a.empty() || command.batch_b.empty() || command.a.size() != 1 || !command.b.empty())) {
    return base::usage_error("--batch-a, --batch-b: both are to be named, and one folder of records, not {}",
                             command.a.size() + command.b.size());
  }
  if (!batches && (command.a.empty() || command.b.empty())) {
    return base::usage_error("compare needs records on both sides: stickslip compare A… -- B…");
  }
  if (auto free = check_outputs(command); !free) return tl::unexpected(free.error());
  const bool with_traces = !command.page.empty();
  const Result<report::ChartLibrary> charts =
      with_traces ? report::read_chart_library() : report::ChartLibrary{};
  if (!charts) return tl::unexpected(charts.error());
  const auto side = [&](const std::string& label, const std::string& batch,
                        const std::vector<std::string>& files) {
    return batches ? report::read_batch(label, batch, command.a.front(), with_traces)
                   : report::read_material(label, files, with_traces);
  };
  const Result<report::Material> a = side(command.label_a, command.batch_a, command.a);
  if (!a) return tl::unexpected(a.error());
  const Result<report::Material> b = side(command.label_b, command.batch_b, command.b);
  if (!b) return tl::unexpected(b.error());
  const report::MaterialComparison comparison = report::compare_materials(*a, *b);
  return deliver(command, report::comparison_csv(*a, *b, comparison),
                 with_traces ? report::comparison_page(*a, *b, comparison, *charts) : "",
                 report::comparison_json(*a, *b, comparison), report::comparison_text(*a, *b, comparison));
}

}  // namespace stickslip::cli
