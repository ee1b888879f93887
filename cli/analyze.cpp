#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/effects.hpp"
#include "cli/method_option.hpp"
#include "cli/subcommands.hpp"
#include "cli/transducer_options.hpp"
#include "io/json_text.hpp"
#include "io/print_text.hpp"
#include "io/results_json.hpp"
#include "io/table.hpp"
#include "report/truth_table.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/skipped_corrections.hpp"
#include "core/base/digits.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/record/estimator_field.hpp"
#include "core/record/finding_json.hpp"
#include "core/record/method_text.hpp"
#include "core/record/read_apart.hpp"
#include "core/record/tester_file.hpp"

namespace stickslip::cli {

namespace {

struct AnalyzeOptions {
  std::vector<std::string> files;
  std::string method;     ///< As chosen_method() takes it; empty: that of each record.
  std::string tester;     ///< File of a characterisation; empty: none.
  std::string estimator;  ///< "turning-points" or "fit"; empty: that of each record.
  /// Of analysis::kCorrectionNames, or "nothing" alone; empty: as each record says.
  std::vector<std::string> keep;
  TransducerOptions transducer;  ///< Each part instead of that of each record.
  std::size_t bootstrap = 0;     ///< Drawings of the slips; 0: none.
  std::uint64_t seed = 1;        ///< Of the drawings.
  bool effects = false;          ///< What each of them does, beside the results.
  bool json = false;
};

constexpr int kExact = 6;             // Decimals of what does not scatter.
constexpr int kFewestDrawings = 100;  // For intervals of 95 %.
constexpr int kMostDrawings = 1'000'000;

/// The test against the characterisation, or why it could not be asked.
nlohmann::ordered_json json_of(const std::optional<analysis::TesterCheck>& check) {
  if (!check) return nullptr;
  nlohmann::ordered_json json{
      {"chi_squared", check->chi_squared},
      {"probability", check->probability},
      {"agrees", check->agrees()},
      {"pull_speed", check->pull_speed.value ? nlohmann::ordered_json(*check->pull_speed.value) : nullptr},
      {"pull_speed_standard_error", check->pull_speed.standard_error
                                        ? nlohmann::ordered_json(*check->pull_speed.standard_error)
                                        : nullptr}};
  record::put_findings(check->findings, json);
  return json;
}

/// Nothing if nothing was given.
base::Result<std::optional<analysis::SkippedCorrections>> chosen_corrections(
    const std::vector<std::string>& given) {
  if (given.empty()) return std::optional<analysis::SkippedCorrections>{};
  if (given == std::vector<std::string>{"nothing"}) return std::optional{analysis::SkippedCorrections{}};
  analysis::SkippedCorrections chosen;
  for (const std::string& word : given) {
    const std::optional<analysis::SkippedCorrections> one =
        word.empty() ? std::nullopt : analysis::skipped_from_text(word);
    if (!one) {
      return base::usage_error(
          "--keep {}: must be \"spikes\", \"drift\" or \"first-slip\", or \"nothing\" alone",
          base::one_line(word, 100));
    }
    chosen = analysis::either(chosen, *one);
  }
  return std::optional{chosen};
}

nlohmann::ordered_json json_of(const analysis::Bootstrap& drawn) {
  nlohmann::ordered_json json{{"count", drawn.settings.count},
                              {"seed", drawn.settings.seed},
                              {"converged", drawn.converged},
                              {"block", drawn.block}};
  if (!drawn.reason.empty()) json["reason"] = drawn.reason;
  for (const analysis::BootstrapSpread& spread : drawn.spreads)
    json[std::string{spread.name}] = {{"unit", spread.unit},
                                      {"standard_deviation", spread.standard_deviation},
                                      {"interval", {spread.lowest, spread.highest}}};
  return json;
}

/// Beside the standard errors of the results. \param where  "test 1, FILE"
std::string text_of(const analysis::Bootstrap& drawn, const analysis::TestResults& results,
                    std::string_view where) {
  if (!drawn.reason.empty()) return fmt::format("\n{}: no bootstrap: {}\n", where, drawn.reason);
  std::string text =
      fmt::format("\n{}: slips drawn again {} times in blocks of {}, seed {}; {} fits converged\n", where,
                  drawn.settings.count, drawn.block, drawn.settings.seed, drawn.converged);
  io::Table table{{{.heading = "", .align = io::Table::Align::kLeft},
                   {.heading = "± stat."},
                   {.heading = "bootstrap"},
                   {.heading = "95 % from"},
                   {.heading = "to"}}};
  for (const analysis::BootstrapSpread& spread : drawn.spreads) {
    analysis::for_each_result(results, [&](const analysis::ResultName& name, const analysis::Estimate& own) {
      if (name.name != spread.name) return;
      const double sd = spread.standard_deviation;
      const int decimals = sd > 0.0 ? std::max(base::decimals_of(sd, base::kUncertaintyDigits), 0) : kExact;
      const auto cell = [decimals](double value) { return fmt::format("{:.{}f}", value, decimals); };
      table.add({std::string{name.name}, own.standard_error ? cell(*own.standard_error) : std::string{},
                 cell(spread.standard_deviation), cell(spread.lowest), cell(spread.highest)});
    });
  }
  return text + table.text();
}

base::Result<std::string> run_analyze(const AnalyzeOptions& options) {
  const base::Result<model::Method> method = chosen_method(options.method);
  if (!method) return tl::unexpected(method.error());
  std::optional<detect::EstimatorTier> estimator;
  if (!options.estimator.empty()) {
    estimator = detect::estimator_tier_from_name(options.estimator);
    if (!estimator) {
      return base::usage_error("--estimator {}: must be \"turning-points\" or \"fit\"",
                               base::one_line(options.estimator, 100));
    }
    if (detect::is_former_estimator(options.estimator)) {
      io::print_error(
          "stickslip",
          fmt::format("--estimator {}: this estimator was removed; write \"turning-points\" or \"fit\"",
                      options.estimator));
    }
  }
  const base::Result<std::optional<analysis::SkippedCorrections>> skipped = chosen_corrections(options.keep);
  if (!skipped) return tl::unexpected(skipped.error());
  const base::Result<model::Transducer> transducer = stated_transducer(options.transducer);
  if (!transducer) return tl::unexpected(transducer.error());
  estimate::SharedPrior prior;
  if (!options.tester.empty()) {
    const auto coupling = record::load_tester(options.tester);
    if (!coupling) return tl::unexpected(coupling.error());
    prior.coupling = *coupling;
  }
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  std::vector<report::TableRow> rows;
  std::string below;
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    const std::string& file = options.files[i];
    base::Result<record::Record> record = record::read_record_in_turn(options.files, i);
    if (!record) return tl::unexpected(record.error());
    record::ProcessFacts& process = record->header.process;
    const std::optional<std::int64_t> record_number = record->header.test_number;
    if (estimator) process.estimator = detect::name(*estimator);
    const base::Result<detect::EstimatorTier> tier = record::estimator_of(process);
    if (tier && !options.tester.empty() && *tier != detect::EstimatorTier::kFit) {
      return base::usage_error(
          "{}: --tester needs the fit of the whole test, and the estimator here is \"{}\"; add --estimator "
          "fit",
          file, detect::name(*tier));
    }
    if (!options.method.empty()) process.method = record::method_text(*method);
    record->header.tester.set_transducer(*transducer);
    if (*skipped) process.kept = analysis::text_of(**skipped);
    base::Result<evaluation::TesterAnalysis> analysed =
        evaluation::analyse_with_tester(*record, prior, {}, {options.bootstrap, options.seed});
    if (!analysed) {
      return tl::unexpected(
          base::Error{analysed.error().kind, fmt::format("{}: {}", file, analysed.error().message)});
    }
    record::EndRecord* const end = &analysed->end;
    std::vector<Effect> effects;
    if (options.effects) {
      auto found = effects_of(*std::move(record), prior);
      // The record has been analysed once: what it lacks is said above.
      if (!found) return tl::unexpected(found.error());
      effects = *std::move(found);
    }
    if (options.json) {
      nlohmann::ordered_json test;
      test["file"] = file;
      test.update(io::results_json(end->results, true));
      if (analysed->check || !options.tester.empty()) test["tester_check"] = json_of(analysed->check);
      if (options.effects) test["effects"] = effects_json(effects);
      if (analysed->bootstrap) test["bootstrap"] = json_of(*analysed->bootstrap);
      tests.push_back(std::move(test));
    } else {
      const std::int64_t number = record_number.value_or(static_cast<std::int64_t>(rows.size()) + 1);
      const std::string where = fmt::format("test {}, {}", number, base::printable(file));
      if (options.effects) below += fmt::format("\n{}\n{}", where, effects_text(effects));
      if (analysed->bootstrap) below += text_of(*analysed->bootstrap, end->results, where);
      rows.push_back({number, std::move(end->results), std::move(end->truth), file});
    }
  }
  if (!options.json) return report::format_table(rows) + below;
  using Json = nlohmann::ordered_json;
  return io::json_document(Json{{"tests", std::move(tests)}});
}

}  // namespace

void add_analyze(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<AnalyzeOptions>();
  CLI::App* command = app.add_subcommand("analyze", "run the detector and the estimators over records");
  command->add_option("files", options->files, "records")->required()->type_name("FILE.h5");
  add_method_option(*command, options->method);
  command
      ->add_option("--tester", options->tester,
                   "file that `stickslip characterise` wrote: makes S and K more certain; a test that "
                   "contradicts it has a finding")
      ->type_name("FILE.toml");
  command
      ->add_option("--estimator", options->estimator,
                   "where S and K come from: \"turning-points\" (peak and trough of each slip) or \"fit\" "
                   "(all scans, and "
                   "with them omega, gamma and what needs them); default: as the record says")
      ->type_name("NAME");
  command
      ->add_option(
          "--keep", options->keep,
          "do not correct for this, to see what it does: \"spikes\", \"drift\", "
          "\"first-slip\" (its peak is often not representative), one each time; \"nothing\" corrects "
          "all; default: as the record says")
      ->type_name("WHAT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_transducer_options(*command, options->transducer);
  CLI::Option* const bootstrap =
      command
          ->add_option("--bootstrap", options->bootstrap,
                       "draw the slips again N times and fit them: how S, K and S - K scatter, beside their "
                       "standard errors")
          ->type_name("N")
          ->check(CLI::Range(kFewestDrawings, kMostDrawings));
  command->add_option("--seed", options->seed, "of the drawings; default 1")
      ->type_name("N")
      ->needs(bootstrap);
  command->add_flag("--effects", options->effects,
                    "S, K and S - K with all three taken care of, and with each kept, side by side");
  command->add_flag("--json", options->json,
                    "JSON instead of a table; names as in the record, null where absent");
  command->footer(
      "Examples:\n"
      "  stickslip analyze records/*.h5                     a table, with the truth where it is known\n"
      "  stickslip analyze pull.h5 --effects                what spikes, drift and the first slip do to S - "
      "K\n"
      "  stickslip analyze pull.h5 --bootstrap 1000         are the standard errors right?\n"
      "  stickslip analyze pull.h5 --keep spikes --keep drift --json");
  choose(*command, chosen, [options] { return run_analyze(*options); });
}

}  // namespace stickslip::cli
