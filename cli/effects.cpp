#include "cli/effects.hpp"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "io/or_null.hpp"
#include "io/table.hpp"
#include "io/uncertain.hpp"
#include <nlohmann/json.hpp>

#include "core/evaluation/analyse.hpp"

namespace stickslip::cli {
namespace {

using analysis::Estimate;
using analysis::TestResults;

constexpr std::array<std::pair<std::string_view, const Estimate TestResults::*>, 4> kShown{
    {{"mu_s", &TestResults::mu_s},
     {"mu_k", &TestResults::mu_k},
     {"delta_mu", &TestResults::delta_mu},
     {"static_coefficient", &TestResults::static_coefficient}}};

std::string label(const analysis::SkippedCorrections& skipped) {
  return skipped.none() ? "all taken care of" : analysis::text_of(skipped) + " kept";
}

}  // namespace

base::Result<std::vector<Effect>> effects_of(record::Record record, const estimate::SharedPrior& prior) {
  std::vector<Effect> effects{{{}, {}}};
  for (const analysis::CorrectionName& name : analysis::kCorrectionNames) {
    effects.emplace_back();
    effects.back().skipped.*name.flag = true;
  }
  for (Effect& effect : effects) {
    record.header.process.kept = analysis::text_of(effect.skipped);
    base::Result<evaluation::TesterAnalysis> analysed = evaluation::analyse_with_tester(record, prior);
    if (!analysed) return tl::unexpected(analysed.error());
    effect.results = std::move(analysed->end.results);
  }
  return effects;
}

std::string effects_text(std::span<const Effect> effects) {
  using enum io::Table::Align;
  io::Table table{{{.heading = "", .align = kLeft},
                   {.heading = "S−K"},
                   {.heading = "change", .format = "+.5f"},
                   {.heading = "S"},
                   {.heading = "K"},
                   {.heading = "static"},
                   {.heading = "regime", .align = kLeft}}};
  const auto shown = [](const Estimate& estimate) { return io::uncertain(estimate, 4).text(); };
  for (const Effect& effect : effects) {
    const Estimate& own = effect.results.delta_mu;
    const Estimate& all = effects.front().results.delta_mu;
    io::Table::Cell change = "";
    if (&effect != &effects.front() && own.value && all.value) change = *own.value - *all.value;
    table.add({label(effect.skipped), shown(own), change, shown(effect.results.mu_s),
               shown(effect.results.mu_k), shown(effect.results.static_coefficient),
               io::cell(model::name(effect.results.regime))});
    if (!own.value) table.add({fmt::format("{}  no S−K: {}", io::kAbsent, own.reason)});
  }
  return table.text();
}

nlohmann::ordered_json effects_json(std::span<const Effect> effects) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Effect& effect : effects) {
    nlohmann::ordered_json own{{"kept", analysis::text_of(effect.skipped)},
                               {"regime", model::name(effect.results.regime)}};
    for (const auto& [name, estimate] : kShown) {
      own[std::string{name}] = io::or_null((effect.results.*estimate).value);
      own[std::string{name} + "_standard_error"] = io::or_null((effect.results.*estimate).standard_error);
      own[std::string{name} + "_systematic_uncertainty"] =
          io::or_null((effect.results.*estimate).systematic_uncertainty);
    }
    json.push_back(std::move(own));
  }
  return json;
}

}  // namespace stickslip::cli
