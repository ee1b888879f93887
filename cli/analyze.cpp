#include <fmt/format.h>

#include <optional>
#include <utility>

#include "cli/commands.hpp"
#include "cli/effects.hpp"
#include "cli/method_option.hpp"
#include "io/json_text.hpp"
#include "io/results_json.hpp"
#include "report/table.hpp"
#include <nlohmann/json.hpp>

#include "core/analysis/kept.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/evaluation/analyse.hpp"
#include "core/record/estimator_field.hpp"
#include "core/record/method_text.hpp"
#include "core/record/read_apart.hpp"
#include "core/record/tester_file.hpp"

namespace stickslip::cli {

namespace {

/// The test against the characterisation, or why it could not be asked.
nlohmann::ordered_json json_of(const std::optional<analysis::TesterCheck>& check) {
  if (!check) return nullptr;
  return {
      {"chi_squared", check->chi_squared},
      {"probability", check->probability},
      {"agrees", check->agrees()},
      {"pull_speed", check->pull_speed.value ? nlohmann::ordered_json(*check->pull_speed.value) : nullptr},
      {"pull_speed_standard_error", check->pull_speed.standard_error
                                        ? nlohmann::ordered_json(*check->pull_speed.standard_error)
                                        : nullptr},
      {"findings", check->findings}};
}

/// Nothing if nothing was given.
base::Result<std::optional<analysis::Kept>> chosen_kept(const std::vector<std::string>& given) {
  if (given.empty()) return std::optional<analysis::Kept>{};
  if (given == std::vector<std::string>{"nothing"}) return std::optional{analysis::Kept{}};
  analysis::Kept chosen;
  for (const std::string& word : given) {
    const std::optional<analysis::Kept> one = word.empty() ? std::nullopt : analysis::kept_from_text(word);
    if (!one) {
      return base::usage_error(
          "--keep {}: must be \"spikes\", \"drift\" or \"first-slip\", or \"nothing\" alone",
          base::one_line(word, 100));
    }
    chosen = analysis::either(chosen, *one);
  }
  return std::optional{chosen};
}

}  // namespace

base::Result<std::string> run_analyze(const AnalyzeCommand& command) {
  const base::Result<model::Method> method = chosen_method(command.method);
  if (!method) return tl::unexpected(method.error());
  std::optional<detect::EstimatorTier> estimator;
  if (!command.estimator.empty()) {
    estimator = detect::estimator_tier_from_name(command.estimator);
    if (!estimator) {
      return base::usage_error("--estimator {}: must be \"peak\", \"interpolated\" or \"fit\"",
                               base::one_line(command.estimator, 100));
    }
  }
  const base::Result<std::optional<analysis::Kept>> kept = chosen_kept(command.keep);
  if (!kept) return tl::unexpected(kept.error());
  estimate::SharedPrior prior;
  if (!command.tester.empty()) {
    const auto coupling = record::load_tester(command.tester);
    if (!coupling) return tl::unexpected(coupling.error());
    prior.coupling = *coupling;
  }
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  std::vector<report::TableRow> rows;
  std::string effects_below;
  for (std::size_t i = 0; i < command.files.size(); ++i) {
    const std::string& file = command.files[i];
    base::Result<record::Record> record =
        record::read_record_apart(file, i + 1 < command.files.size() ? command.files[i + 1] : std::string{});
    if (!record) return tl::unexpected(record.error());
    record::ProcessFacts& process = record->header.process;
    const std::optional<std::int64_t> record_number = record->header.test_number;
    if (estimator) process.estimator = detect::name(*estimator);
    const base::Result<detect::EstimatorTier> tier = record::estimator_of(process);
    if (tier && !command.tester.empty() && *tier != detect::EstimatorTier::kFit) {
      return base::usage_error(
          "{}: --tester needs the fit of the whole test, and the estimator here is \"{}\"; add --estimator "
          "fit",
          file, detect::name(*tier));
    }
    if (!command.method.empty()) process.method = record::method_text(*method);
    if (*kept) process.kept = analysis::text_of(**kept);
    base::Result<evaluation::TesterAnalysis> analysed = evaluation::analyse_with_tester(*record, prior);
    if (!analysed) {
      return tl::unexpected(
          base::Error{analysed.error().kind, fmt::format("{}: {}", file, analysed.error().message)});
    }
    record::EndRecord* const end = &analysed->end;
    std::vector<Effect> effects;
    if (command.effects) {
      auto found = effects_of(*std::move(record), prior);
      // The record has been analysed once: what it lacks is said above.
      if (!found) return tl::unexpected(found.error());
      effects = *std::move(found);
    }
    if (command.json) {
      nlohmann::ordered_json test;
      test["file"] = file;
      test.update(io::results_json(end->results, true));
      if (analysed->check || !command.tester.empty()) test["tester_check"] = json_of(analysed->check);
      if (command.effects) test["effects"] = effects_json(effects);
      tests.push_back(std::move(test));
    } else {
      const std::int64_t number = record_number.value_or(static_cast<std::int64_t>(rows.size()) + 1);
      rows.push_back({number, std::move(end->results), std::move(end->truth), file});
      if (command.effects)
        effects_below +=
            fmt::format("\ntest {}, {}\n{}", number, base::printable(file), effects_text(effects));
    }
  }
  if (!command.json) return report::format_table(rows) + effects_below;
  using Json = nlohmann::ordered_json;
  return io::json_document(Json{{"tests", std::move(tests)}});
}

}  // namespace stickslip::cli
