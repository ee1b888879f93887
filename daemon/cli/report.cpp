#include <fmt/format.h>

#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/record/finaliser.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/new_file.hpp"
#include "daemon/report/report_json.hpp"
#include "daemon/report/report_page.hpp"
#include "daemon/report/report_text.hpp"
#include "daemon/report/test_report.hpp"

namespace stickslip::daemon {
namespace {

using base::Result;
using Json = nlohmann::ordered_json;

/// Before the work, not only after it.
Result<void> check_outputs(const ReportOptions& options) {
  for (const std::string& file : {options.csv, options.page}) {
    if (file.empty()) continue;
    if (auto free = record::check_publishable(file); !free) return free;
  }
  if (!options.csv.empty() && options.csv == options.page) {
    return base::usage_error("--csv and -o name the same file, {}", options.csv);
  }
  return {};
}

std::string dumped(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

/// Files first, so that nothing is printed before all has succeeded.
Result<std::string> deliver(const ReportOptions& options, const std::string& csv, const std::string& page,
                            const Json& json, const std::string& text) {
  if (!options.csv.empty()) {
    if (auto written = write_new_file(options.csv, csv); !written) return tl::unexpected(written.error());
  }
  if (!options.page.empty()) {
    if (auto written = write_new_file(options.page, page); !written) return tl::unexpected(written.error());
  }
  return options.json ? dumped(json) : text;
}

}  // namespace

Result<std::string> run_report(const ReportCommand& command) {
  if (auto free = check_outputs(command); !free) return tl::unexpected(free.error());
  if (!command.batch.empty() && command.files.size() != 1) {
    return base::usage_error("--batch {}: one folder of records is to be named, not {}", command.batch,
                             command.files.size());
  }
  const bool with_traces = !command.page.empty();
  const Result<Material> material = command.batch.empty()
                                        ? read_material("", command.files, with_traces)
                                        : read_batch(command.batch, command.files.front(), with_traces);
  if (!material) return tl::unexpected(material.error());
  return deliver(command, report_csv(*material), command.page.empty() ? "" : report_page(*material),
                 report_json(*material), report_text(*material));
}

Result<std::string> run_compare(const CompareCommand& command) {
  if (command.a.empty() || command.b.empty()) {
    return base::usage_error("compare needs records on both sides: stickslip compare A… -- B…");
  }
  if (auto free = check_outputs(command); !free) return tl::unexpected(free.error());
  const bool with_traces = !command.page.empty();
  const Result<Material> a = read_material(command.label_a, command.a, with_traces);
  if (!a) return tl::unexpected(a.error());
  const Result<Material> b = read_material(command.label_b, command.b, with_traces);
  if (!b) return tl::unexpected(b.error());
  const MaterialComparison comparison = compare_materials(*a, *b);
  return deliver(command, comparison_csv(*a, *b, comparison),
                 with_traces ? comparison_page(*a, *b, comparison) : "", comparison_json(*a, *b, comparison),
                 comparison_text(*a, *b, comparison));
}

}  // namespace stickslip::daemon
