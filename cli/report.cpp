#include <memory>
#include <string>
#include <vector>

#include "cli/report_outputs.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "report/report_json.hpp"
#include "report/report_page.hpp"
#include "report/report_text.hpp"
#include "report/test_report.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using base::Result;

struct ReportOptions : ReportOutputs {
  std::vector<std::string> files;  ///< Of a batch: the folder of its records, one.
  std::string pool;                ///< "grades", "regimes" or both; empty: neither.
  std::string batch;               ///< Its identifier or name; empty: the files are records.
};

Result<std::string> run_report(const ReportOptions& options) {
  if (auto free = check_outputs(options); !free) return tl::unexpected(free.error());
  if (!options.batch.empty() && options.files.size() != 1) {
    return base::usage_error("--batch {}: one folder of records is to be named, not {}", options.batch,
                             options.files.size());
  }
  const Result<analysis::Pooling> pooling = report::pooling_from_text(options.pool, "--pool");
  if (!pooling) return tl::unexpected(pooling.error());
  const bool with_traces = !options.page.empty();
  const Result<report::ChartLibrary> charts =
      with_traces ? report::read_chart_library() : report::ChartLibrary{};
  if (!charts) return tl::unexpected(charts.error());
  Result<report::Material> material =
      options.batch.empty()
          ? report::read_material("", options.files, detail_of(options), *pooling)
          : report::read_batch("", options.batch, options.files.front(), detail_of(options), *pooling);
  if (!material) return tl::unexpected(material.error());
  report::note_repeated_scans({&*material});
  return deliver(options, {.csv = [&] { return report::report_csv(*material); },
                           .page = [&] { return report::report_page(*material, *charts); },
                           .json = [&] { return io::json_document(report::report_json(*material)); },
                           .text = [&] { return report::report_text(*material); }});
}

constexpr const char* kReportExamples =
    R"(Shows the results that stand in records: what was tested and how, the verdict, and for each grade, regime and speed
mean, scatter s_r, repeatability r = 2.8 s_r, 95 % confidence interval, outliers (named, never left out).

Examples:
  stickslip report records/*.h5
  stickslip report pull.h5 -o pull.html                one page with traces to zoom in; needs no network
  stickslip report --batch "liner 42" records          the tests of a batch that were not voided, and its limits
  stickslip report records/*.h5 --pool regimes         one mean over tests that stuck and tests that rang down
  stickslip report records/*.h5 --json --csv tests.csv)";

}  // namespace

void add_report(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* command =
      app.add_subcommand("report", "summarise replicates: means, repeatability, coefficient against speed");
  command->footer(kReportExamples);
  command->add_option("files", options->files, "records; with --batch the folder they are in")
      ->required()
      ->type_name("FILE.h5");
  command->add_option("--batch", options->batch, "all tests of a batch, by its identifier or name")
      ->type_name("BATCH");
  command
      ->add_option(
          "--pool", options->pool,
          "average over what differs: grades, regimes or grades,regimes; else each has its own means")
      ->type_name("WHAT");
  add_report_outputs(*command, *options);
  choose(*command, chosen, [options] { return run_report(*options); });
}

}  // namespace stickslip::cli
