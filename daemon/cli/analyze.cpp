#include <fmt/format.h>

#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/friction/kept.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/analyse.hpp"
#include "daemon/cli/commands.hpp"
#include "daemon/cli/effects.hpp"
#include "daemon/cli/method_option.hpp"
#include "daemon/json_text.hpp"
#include "daemon/method_text.hpp"
#include "daemon/report/table.hpp"
#include "daemon/results_json.hpp"
#include "daemon/tester_file.hpp"

namespace stickslip::daemon {

namespace {

/// The test against the characterisation, or why it could not be asked.
nlohmann::ordered_json json_of(const std::optional<friction::TesterCheck>& check) {
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
base::Result<std::optional<friction::Kept>> chosen_kept(const std::vector<std::string>& given) {
  if (given.empty()) return std::optional<friction::Kept>{};
  if (given == std::vector<std::string>{"nothing"}) return std::optional{friction::Kept{}};
  friction::Kept chosen;
  for (const std::string& word : given) {
    const std::optional<friction::Kept> one = word.empty() ? std::nullopt : friction::kept_from_text(word);
    if (!one) {
      return base::usage_error(
          "--keep {}: must be \"spikes\", \"drift\" or \"first-slip\", or \"nothing\" alone",
          base::one_line(word, 100));
    }
    chosen = friction::either(chosen, *one);
  }
  return std::optional{chosen};
}

}  // namespace

base::Result<std::string> run_analyze(const AnalyzeCommand& command) {
  const base::Result<friction::Method> method = chosen_method(command.method);
  if (!method) return tl::unexpected(method.error());
  std::optional<friction::EstimatorTier> estimator;
  if (!command.estimator.empty()) {
    estimator = friction::estimator_tier_from_name(command.estimator);
    if (!estimator) {
      return base::usage_error("--estimator {}: must be \"peak\", \"interpolated\" or \"fit\"",
                               base::one_line(command.estimator, 100));
    }
  }
  const base::Result<std::optional<friction::Kept>> kept = chosen_kept(command.keep);
  if (!kept) return tl::unexpected(kept.error());
  friction::SharedPrior prior;
  if (!command.tester.empty()) {
    const auto coupling = load_tester(command.tester);
    if (!coupling) return tl::unexpected(coupling.error());
    prior.coupling = *coupling;
  }
  nlohmann::ordered_json tests = nlohmann::ordered_json::array();
  std::vector<TableRow> rows;
  std::string effects_below;
  for (std::size_t i = 0; i < command.files.size(); ++i) {
    const std::string& file = command.files[i];
    base::Result<record::Record> record =
        record::read_record_apart(file, i + 1 < command.files.size() ? command.files[i + 1] : std::string{});
    if (!record) return tl::unexpected(record.error());
    std::string& text = record->header.process.method;
    const std::optional<std::int64_t> record_number = record->header.test_number;
    const friction::EstimatorTier tier = estimator.value_or(estimator_from_text(text));
    if (!command.tester.empty() && tier != friction::EstimatorTier::kFit) {
      return base::usage_error(
          "{}: --tester needs the fit of the whole test, and the estimator here is \"{}\"; add --estimator "
          "fit",
          file, name(tier));
    }
    if (!command.method.empty()) text = method_text(*method);
    // An empty text is the default method, which is written only where something stands behind it.
    if (text.empty() && tier != friction::EstimatorTier::kFit) text = method_text({});
    text = with_estimator(text, tier);
    if (*kept) record->header.process.kept = friction::text_of(**kept);
    base::Result<TesterAnalysis> analysed = analyse_with_tester(*record, prior);
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
      test.update(results_json(end->results, true));
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
  if (!command.json) return format_table(rows) + effects_below;
  using Json = nlohmann::ordered_json;
  return json_document(Json{{"tests", std::move(tests)}});
}

}  // namespace stickslip::daemon
