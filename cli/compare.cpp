#include <fmt/format.h>

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

struct CompareOptions : ReportOutputs {
  std::vector<std::string> a;  ///< Of two batches: the folder of their records, one.
  std::vector<std::string> b;
  std::string batch_a;  ///< Its identifier or name; empty: the files are records.
  std::string batch_b;
  std::string label_a;  ///< Empty: the batch's name, else A.
  std::string label_b;
  std::string pool;  ///< As of `stickslip report`.
};

Result<std::string> run_compare(const CompareOptions& options) {
  const bool batches = !options.batch_a.empty() || !options.batch_b.empty();
  if (batches &&
      (options.batch_a.empty() || options.batch_b.empty() || options.a.size() != 1 || !options.b.empty())) {
    return base::usage_error("--batch-a, --batch-b: both are to be named, and one folder of records, not {}",
                             options.a.size() + options.b.size());
  }
  if (!batches && (options.a.empty() || options.b.empty())) {
    return base::usage_error("compare needs records on both sides: stickslip compare A… -- B…");
  }
  if (auto free = check_outputs(options); !free) return tl::unexpected(free.error());
  const bool with_traces = !options.page.empty();
  const Result<report::ChartLibrary> charts =
      with_traces ? report::read_chart_library() : report::ChartLibrary{};
  if (!charts) return tl::unexpected(charts.error());
  Result<analysis::Pooling> pooling = report::pooling_from_text(options.pool, "--pool");
  if (!pooling) return tl::unexpected(pooling.error());
  pooling->regimes = true;  // Each side is one material; how many of its tests stick is compared beside.
  const auto side = [&](const char* letter, const std::string& label, const std::string& batch,
                        const std::vector<std::string>& files) -> Result<report::Material> {
    Result<report::Material> own =
        batches ? report::read_batch(label, batch, options.a.front(), detail_of(options), *pooling)
                : report::read_material(label.empty() ? letter : label, files, detail_of(options), *pooling);
    if (!own) return own;
    if (auto one = report::check_one_grade(*own, letter); !one) return tl::unexpected(one.error());
    return own;
  };
  Result<report::Material> a = side("A", options.label_a, options.batch_a, options.a);
  if (!a) return tl::unexpected(a.error());
  Result<report::Material> b = side("B", options.label_b, options.batch_b, options.b);
  if (!b) return tl::unexpected(b.error());
  // Two batches of one name are told apart.
  if (batches && a->label == b->label) {
    a->label += fmt::format(" ({})", options.batch_a);
    b->label += fmt::format(" ({})", options.batch_b);
  }
  report::note_repeated_scans({&*a, &*b});
  const report::MaterialComparison comparison = report::compare_materials(*a, *b);
  return deliver(options,
                 {.csv = [&] { return report::comparison_csv(*a, *b, comparison); },
                  .page = [&] { return report::comparison_page(*a, *b, comparison, *charts); },
                  .json = [&] { return io::json_document(report::comparison_json(*a, *b, comparison)); },
                  .text = [&] { return report::comparison_text(*a, *b, comparison); }});
}

constexpr const char* kCompareExamples =
    R"(Compares two materials at each speed: difference with 95 % interval, Welch's t test, effect size (Hedges' g), and how
many tests of each would have found a difference as large with 80 % and 90 % probability.

Examples:
  stickslip compare thorold/*.h5 -- baie-comeau/*.h5 --label-a Thorold --label-b "Baie Comeau"
  stickslip compare a*.h5 -- b*.h5 -o comparison.html
  stickslip compare --batch-a "liner 42" --batch-b "liner 43" records -o comparison.html
  stickslip compare a*.h5 -- b*.h5 --json --csv comparison.csv)";

}  // namespace

void add_compare(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<CompareOptions>();
  CLI::App* command = app.add_subcommand("compare", "compare two materials: stickslip compare A… -- B…");
  command->footer(kCompareExamples);
  command->add_option("a", options->a, "records of the one; with --batch-a the folder of both batches")
      ->type_name("A.h5");
  command->add_option(kOtherMaterial, options->b, "records of the other; a plain -- does the same")
      ->type_name("B.h5");
  command->add_option("--batch-a", options->batch_a, "all tests of a batch, by its identifier or name")
      ->type_name("BATCH");
  command->add_option("--batch-b", options->batch_b, "all tests of the other batch")->type_name("BATCH");
  command
      ->add_option("--label-a", options->label_a, "what the one is called; default: the batch's name, else A")
      ->type_name("NAME");
  command
      ->add_option("--label-b", options->label_b,
                   "what the other is called; default: the batch's name, else B")
      ->type_name("NAME");
  command
      ->add_option("--pool", options->pool,
                   "grades: a side may have several, and is compared as one material")
      ->type_name("WHAT");
  add_report_outputs(*command, *options);
  choose(*command, chosen, [options] { return run_compare(*options); });
}

}  // namespace stickslip::cli
