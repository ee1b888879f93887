#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/law_figure.hpp"
#include "cli/options.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include "io/new_file.hpp"
#include "io/or_null.hpp"
#include "io/table.hpp"
#include "io/uncertain.hpp"
#include "report/plot/figure.hpp"
#include "report/test_report.hpp"
#include <nlohmann/json.hpp>

#include "core/base/digits.hpp"
#include "core/base/text.hpp"
#include "core/law/friction_law.hpp"
#include "core/law/measured_tests.hpp"
#include "core/law/next_pull.hpp"
#include "core/record/finaliser.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;
using base::Dimension;
using base::Result;
using law::Dependence;
using law::FrictionLaw;
using law::Law;
using law::LawTest;

struct LawOptions {
  std::vector<std::string> files;
  std::string slowest;  ///< Of the tester; empty: a third of the slowest test's.
  std::string fastest;
  std::string plot;  ///< Empty: none.
  std::string pool;  ///< As of `stickslip report`.
  bool json = false;
};

/// What the outputs show.
struct Shown {
  report::Material material;
  law::LawTests tests;
  FrictionLaw law;
  std::optional<law::NextPull> next;
};

constexpr double kMillisecondsPerSecond = 1e3;
constexpr int kLawDecimals = 4;
/// Of the table of tests, which has 80 columns: two more with an error.
constexpr int kDecimalsOfTests = 3;

/// A parameter of the law with its name in JSON, its symbol and its unit.
struct Named {
  const char* name;
  const char* symbol;
  const char* unit;  ///< In JSON.
  const char* meaning;
  analysis::Estimate value;
};

std::vector<Named> parameters_of(const FrictionLaw& found) {
  std::vector<Named> named;
  const auto add = [&named](const char* name, const char* symbol, const char* unit, const char* meaning,
                            const law::Parameter& own) {
    const std::optional<double> systematic =
        own.systematic > 0.0 ? std::optional{own.systematic} : std::nullopt;
    named.push_back({name, symbol, unit, meaning, {own.value, own.error, systematic, {}}});
  };
  if (found.is_rate_and_state()) {
    const law::RateAndState& own = *found.rate_and_state;
    add("a", "a", "1", "for each factor of e in speed", own.a);
    add("b", "b", "1", "for each factor of e in time at rest", own.b);
    named.push_back({"critical_slip", "D_c", "m", "of sliding makes contacts new",
                     analysis::Estimate::of(own.critical_slip_m)});
    return named;
  }
  const bool ages = has_ageing(found.law);
  if (const auto& S = found.ageing.fitted(ages)) {
    add(ages ? "mu_s_at_1_s" : "mu_s", ages ? "S₁" : "S", "1", ages ? "after 1 s at rest" : "", S->level);
    if (ages) add("beta", "β", "1", "for each decade of time at rest", *S->slope);
  }
  const bool rates = has_rate(found.law);
  if (const auto& K = found.rate.fitted(rates)) {
    add(rates ? "mu_k_at_0" : "mu_k", rates ? "K₀" : "K", "1", rates ? "at speed 0" : "", K->level);
    if (rates) add("mu_slope", "µ'", "s/m", "s/m", *K->slope);
  }
  return named;
}

/// Measured less the law; nullopt if the test has no such value.
std::optional<double> residual(const FrictionLaw& found, const Dependence& own, bool with_slope,
                               std::size_t test) {
  const auto at = std::find(own.tests.begin(), own.tests.end(), test);
  const std::optional<law::Line>& line = own.fitted(with_slope);
  if (at == own.tests.end() || !line) return std::nullopt;
  const law::Point& point = own.points[static_cast<std::size_t>(at - own.tests.begin())];
  if (found.is_rate_and_state()) {
    if (&own == &found.rate || !found.rate_and_state->S[test]) return std::nullopt;
    return point.y - *found.rate_and_state->S[test];
  }
  return point.y - line->predicted(point.x).value;
}

std::string coefficient_text(const std::optional<law::Value>& value) {
  return value ? io::uncertain({value->value, value->error, {}, {}}, kDecimalsOfTests).text() : "";
}

std::string residual_text(const std::optional<double>& value) {
  if (!value) return "";
  return std::abs(*value) < 0.5 * std::pow(10.0, -kLawDecimals)
             ? fmt::format("{:.{}f}", 0.0, kLawDecimals)
             : fmt::format("{:+.{}f}", *value, kLawDecimals);
}

std::string tests_table(const Shown& shown) {
  using enum io::Table::Align;
  io::Table table{{{.heading = "n"},
                   {.heading = "speed"},
                   {.heading = "rest (ms)"},
                   {.heading = "S", .align = kLeft},
                   {.heading = "off"},
                   {.heading = "K", .align = kLeft},
                   {.heading = "off"}}};
  std::string files;
  for (std::size_t i = 0; i < shown.tests.tests.size(); ++i) {
    const LawTest& test = shown.tests.tests[i];
    const std::size_t number = shown.tests.measured[i];
    table.add({io::cell(number + 1), base::speed_text(test.pull_speed_m_per_s),
               test.S ? fmt::format("{:.1f}", *test.stick_time_s * kMillisecondsPerSecond) : "",
               coefficient_text(test.S),
               residual_text(residual(shown.law, shown.law.ageing, has_ageing(shown.law.law), i)),
               coefficient_text(test.K),
               residual_text(residual(shown.law, shown.law.rate, has_rate(shown.law.law), i))});
    if (i > 0 && number == shown.tests.measured[i - 1]) continue;
    files +=
        fmt::format("file of test {}: {}\n", number + 1, base::printable(shown.material.tests[number].file));
  }
  return table.text() + files;
}

std::string scores_table(const std::array<law::LawScore, law::kLaws.size()>& scores) {
  using enum io::Table::Align;
  io::Table table{{{.heading = "law", .align = kLeft},
                   {.heading = "score", .format = ".2f"},
                   {.heading = "behind the best"}}};
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const law::LawScore& own = scores[i];
    table.add({io::cell(name(law::kLaws[i])), own.score,
               own.behind > 0.0 ? fmt::format("{:.2f} ± {:.2f}", own.behind, own.behind_error)
                                : std::string{"best"}});
  }
  return table.text();
}

std::string next_text(const law::NextPull& next) {
  // Of inches per minute: nobody sets a belt more closely for it.
  constexpr double kDigits = 2.0;
  constexpr double kInPerMin_m_per_s = 0.0254 / 60.0;
  const double speed = next.pull_speed_m_per_s / kInPerMin_m_per_s;
  const double step = std::pow(10.0, std::floor(std::log10(speed)) + 1.0 - kDigits);
  return fmt::format("next: {} at {} would tell most about {}\n",
                     next.hold_s ? fmt::format("a hold of {:.3g} s", *next.hold_s) : "a pull",
                     base::speed_text(std::round(speed / step) * step * kInPerMin_m_per_s),
                     next.tells_ageing ? "S" : "K");
}

/// "!  …" in lines of at most 80 columns. \param reason  ASCII.
std::string reason_text(std::string_view reason) {
  constexpr std::size_t kWidth = 77;
  std::string text;
  while (!reason.empty()) {
    std::size_t end = reason.size();
    if (end > kWidth) end = reason.rfind(' ', kWidth);
    end = std::min(end, reason.size());
    text += fmt::format("{}{}\n", text.empty() ? "!  " : "   ", reason.substr(0, end));
    reason.remove_prefix(std::min(reason.size(), end + 1));
  }
  return text;
}

std::string critical_slip_text(const law::RateAndState& found) {
  constexpr double kMicrometresPerMetre = 1e6;
  return fmt::format("{:.1g} µm, within a factor of {:.1g}", kMicrometresPerMetre * found.critical_slip_m,
                     found.within_factor);
}

/// Between pulls the time at rest is as 1/v: ageing and a dependence on the speed are one there.
bool leaves_rate_and_state_open(const FrictionLaw& found) {
  return found.told && has_ageing(found.law) && !found.rate_and_state;
}

std::string text_of(const Shown& shown) {
  const FrictionLaw& found = shown.law;
  std::string text = found.told ? fmt::format("law: {}: {}\n", name(found), in_words(found))
                                : fmt::format("law: cannot be told from these tests; {} leads:\n     {}\n",
                                              name(found), in_words(found));
  for (const Dependence* own : {&found.ageing, &found.rate}) {
    if (!own->reason.empty()) text += reason_text(own->reason);
  }
  if (leaves_rate_and_state_open(found)) {
    text += reason_text(
        "rate-and-state friction is not ruled out: it looks the same without slow pulls and a sheet with "
        "holds");
  }
  if (shown.next) text += next_text(*shown.next);
  io::Table list = io::Table::list({6, 0, 0});
  for (const Named& own : parameters_of(found)) {
    list.add({std::string{"  "} + own.symbol,
              own.value.standard_error ? io::uncertain(own.value, kLawDecimals).text()
                                       : critical_slip_text(*found.rate_and_state),
              std::string{own.meaning}});
  }
  text += fmt::format("\n{}{}\n", list.text(), io::kErrorsLegend);
  if (found.scores && !found.is_rate_and_state())
    text += fmt::format("\nScores: log density of a test by the law of the others\n{}",
                        scores_table(*found.scores));
  text += fmt::format("\nTests; off: measured less the law\n{}", tests_table(shown));
  for (const law::LeftOut& out : shown.tests.left_out) {
    text += fmt::format("x  {} of {} left out: {}\n", out.what,
                        base::printable(shown.material.tests[out.test].file), base::printable(out.reason));
  }
  for (const report::VoidedTest& test : shown.material.voided)
    text += fmt::format("x  {}: void, left out: {}\n", base::printable(test.file),
                        base::printable(test.voiding.reason));
  return text;
}

Json estimate_json(const analysis::Estimate& value, const char* unit) {
  return {{"value", io::or_null(value.value)},
          {"unit", unit},
          {"standard_error", io::or_null(value.standard_error)},
          {"systematic_uncertainty", io::or_null(value.systematic_uncertainty)}};
}

Json coefficient_json(const std::optional<law::Value>& value, const std::optional<double>& off) {
  if (!value) return nullptr;
  Json json = estimate_json({value->value, value->error, std::abs(value->systematic), {}}, "1");
  json["residual"] = io::or_null(off);
  return json;
}

Json json_of(const Shown& shown) {
  const FrictionLaw& found = shown.law;
  Json json{{"law", found.told ? Json(name(found)) : Json(nullptr)},
            {"leading_law", name(found)},
            {"reasons", Json::array()},
            {"not_ruled_out", Json::array()},
            {"next_pull", nullptr},
            {"parameters", Json::object()},
            {"scores", Json::array()},
            {"between_tests", Json::object()},
            {"tests", Json::array()},
            {"left_out", Json::array()}};
  for (const Dependence* own : {&found.ageing, &found.rate}) {
    if (!own->reason.empty()) json["reasons"].push_back(own->reason);
  }
  if (leaves_rate_and_state_open(found)) json["not_ruled_out"].push_back("rate-and-state");
  if (shown.next) {
    json["next_pull"] = {{"pull_speed", shown.next->pull_speed_m_per_s},
                         {"hold", io::or_null(shown.next->hold_s)},
                         {"tells", shown.next->tells_ageing ? "mu_s" : "mu_k"},
                         {"separation", io::or_null(shown.next->separation)}};
  }
  for (const Named& own : parameters_of(found))
    json["parameters"][own.name] = estimate_json(own.value, own.unit);
  if (found.is_rate_and_state())
    json["parameters"]["critical_slip"]["within_factor"] = io::or_null(found.rate_and_state->within_factor);
  for (std::size_t i = 0; found.scores && !found.is_rate_and_state() && i < law::kLaws.size(); ++i) {
    const law::LawScore& own = (*found.scores)[i];
    json["scores"].push_back({{"law", name(law::kLaws[i])},
                              {"score", io::or_null(own.score)},
                              {"behind", io::or_null(own.behind)},
                              {"behind_standard_error", io::or_null(own.behind_error)}});
  }
  for (const auto& [key, own, with_slope] : {std::tuple{"mu_s", &found.ageing, has_ageing(found.law)},
                                             {"mu_k", &found.rate, has_rate(found.law)}}) {
    const std::optional<law::Line>& line = own->fitted(with_slope);
    if (found.is_rate_and_state()) {
      json["between_tests"][key] =
          own == &found.ageing ? Json(std::sqrt(found.rate_and_state->between_variance)) : Json(nullptr);
      continue;
    }
    json["between_tests"][key] = line ? Json(std::sqrt(line->between_variance)) : Json(nullptr);
  }
  for (std::size_t i = 0; i < shown.tests.tests.size(); ++i) {
    const LawTest& test = shown.tests.tests[i];
    json["tests"].push_back(
        {{"file", shown.material.tests[shown.tests.measured[i]].file},
         {"pull_speed", test.pull_speed_m_per_s},
         {"stick_time", io::or_null(test.stick_time_s)},
         {"held", test.held},
         {"mu_s", coefficient_json(test.S, residual(found, found.ageing, has_ageing(found.law), i))},
         {"mu_k", coefficient_json(test.K, residual(found, found.rate, has_rate(found.law), i))}});
  }
  for (const law::LeftOut& out : shown.tests.left_out) {
    json["left_out"].push_back(
        {{"file", shown.material.tests[out.test].file}, {"what", out.what}, {"reason", out.reason}});
  }
  for (const report::VoidedTest& test : shown.material.voided) {
    json["left_out"].push_back(
        {{"file", test.file}, {"what", "S and K"}, {"reason", fmt::format("void: {}", test.voiding.reason)}});
  }
  return json;
}

Result<law::SpeedRange> range_of(const LawOptions& options, const law::LawTests& tests) {
  const auto slowest = number_of("--slowest", options.slowest, Dimension::kSpeed, true);
  if (!slowest) return tl::unexpected(slowest.error());
  const auto fastest = number_of("--fastest", options.fastest, Dimension::kSpeed, true);
  if (!fastest) return tl::unexpected(fastest.error());
  const law::SpeedRange usual = law::usual_range(tests.tests);
  const law::SpeedRange range{slowest->value_or(usual.from_m_per_s), fastest->value_or(usual.to_m_per_s)};
  if (!(range.from_m_per_s < range.to_m_per_s)) {
    return base::usage_error("--slowest, --fastest: {} is not below {}", base::speed_text(range.from_m_per_s),
                             base::speed_text(range.to_m_per_s));
  }
  return range;
}

/// Above it a sled as in these tests does not stick again; absent if no test tells it.
std::optional<double> highest_sticking(const report::Material& material) {
  std::optional<double> lowest;
  for (const analysis::MeasuredTest& test : material.measured) {
    const std::optional<double>& own = test.results.threshold_speed.value;
    if (own && *own > 0.0) lowest = std::min(lowest.value_or(*own), *own);
  }
  return lowest;
}

Result<std::string> run_law(const LawOptions& options) {
  std::optional<plot::PictureFormat> format;
  if (!options.plot.empty()) {  // Before the work, not only after it.
    const Result<plot::PictureFormat> known = plot::format_of_file(options.plot);
    if (!known) return tl::unexpected(known.error());
    if (auto free = record::check_publishable(options.plot); !free) return tl::unexpected(free.error());
    format = *known;
  }
  const Result<analysis::Pooling> pooling = report::pooling_from_text(options.pool, "--pool");
  if (!pooling) return tl::unexpected(pooling.error());
  Result<report::Material> material =
      report::read_material("", options.files, report::Detail::kResults, *pooling);
  if (!material) return tl::unexpected(material.error());
  if (auto one = report::check_one_grade(*material, "law"); !one) return tl::unexpected(one.error());
  report::note_repeated_scans({&*material});
  Shown shown{*std::move(material), {}, {}, {}};
  shown.tests = law::tests_for_law(shown.material.measured);
  if (shown.tests.tests.empty()) {
    const law::LeftOut& first = shown.tests.left_out.front();
    return base::usage_error("{}: {}: {}; and no other test has S or K: name tests of a known pull speed",
                             shown.material.tests[first.test].file, first.what, first.reason);
  }
  const auto range = range_of(options, shown.tests);
  if (!range) return tl::unexpected(range.error());
  shown.law = law::find_law(shown.tests.tests);
  shown.next = law::next_pull(shown.law, shown.tests.tests, *range, highest_sticking(shown.material));
  if (format) {
    const Result<std::string> picture = plot::draw(law_figure(shown.law), *format);
    if (!picture) return tl::unexpected(picture.error());
    if (auto written = io::write_new_file(options.plot, *picture); !written)
      return tl::unexpected(written.error());
  }
  return options.json ? io::json_document(json_of(shown)) : text_of(shown);
}

constexpr const char* kLawExamples =
    R"(Names the friction law of a paper from tests at several pull speeds: are S and K constant, does S grow with the time
at rest before a slip, does K change with the speed? Says so where the tests cannot tell, and which pull would.
Needs four tests at two speeds, or one with holds; docs/friction-laws.md says how to plan them.

Examples:
  stickslip law records/*.h5
  stickslip law slow*.h5 fast*.h5 --plot law.svg --slowest "0.5 in/min" --fastest "40 in/min"
  stickslip law records/*.h5 --json > law.json)";

}  // namespace

void add_law(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<LawOptions>();
  CLI::App* command = app.add_subcommand("law", "find the friction law from tests at several pull speeds");
  command->footer(kLawExamples);
  command->add_option("files", options->files, "records of one paper")->required()->type_name("FILE.h5");
  command
      ->add_option("--slowest", options->slowest,
                   "slowest pull of the tester, for the advice; default: a third of the slowest test's")
      ->type_name("SPEED");
  command->add_option("--fastest", options->fastest, "fastest pull; default: three times the fastest test's")
      ->type_name("SPEED");
  command->add_option("--plot", options->plot, "picture to make, .svg or .png; must not exist")
      ->type_name("FILE.svg");
  command->add_option("--pool", options->pool, "grades: tests of several grades, as one paper")
      ->type_name("WHAT");
  command->add_flag("--json", options->json,
                    "JSON instead of tables; SI units, null where there is no number");
  choose(*command, chosen, [options] { return run_law(*options); });
}

}  // namespace stickslip::cli
