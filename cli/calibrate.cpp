#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/options.hpp"
#include "cli/subcommands.hpp"
#include "cli/weighing.hpp"
#include "io/calibration_file.hpp"
#include "io/findings_text.hpp"
#include "io/json_text.hpp"
#include "io/table.hpp"
#include "io/traces/cell.hpp"
#include <nlohmann/json.hpp>

#include "core/base/settings.hpp"
#include "core/base/text.hpp"
#include "core/daq/gain_change.hpp"
#include "core/record/finding_json.hpp"
#include "daemon/types/calibration_json.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;
using base::Dimension;
using base::Limits;
using base::Result;

/// Numbers as typed.
struct CalibrateOptions {
  std::string config;  ///< Of the daemon: its board is read. Empty: points are given.
  std::string points;  ///< Readings made elsewhere, TOML. Empty: the board is read.
  std::string folder;  ///< The history; empty: that of the configuration.
  std::string certificate;
  std::string valid_days = "365";  ///< 0: for ever.
  std::string settle = "1 s";
  std::string reading = "2 s";
  bool confirm = false;  ///< A daq::GainChange is meant.
  bool json = false;
};

/// All there is to judge.
struct Weighed {
  std::vector<daq::WeightReading> readings;
  double gravity_m_per_s2 = 9.80665;
  double span_V = 0.0;

  [[nodiscard]] daq::WeighedCalibration result() const {
    return daq::weigh(readings, gravity_m_per_s2, span_V);
  }
};

Result<Weighed> read_points(const std::string& file) {
  Result<base::Settings> settings = base::Settings::load(file);
  if (!settings) return tl::unexpected(settings.error());
  Weighed weighed;
  weighed.gravity_m_per_s2 =
      settings->quantity("gravity", Dimension::kAcceleration, Limits::above(0.0), weighed.gravity_m_per_s2);
  weighed.span_V = settings->quantity("span", Dimension::kVoltage, Limits::at_least(0.0), 0.0);
  for (base::Settings& point : settings->tables("point")) {
    daq::WeightReading reading;
    reading.mass_kg = point.quantity("mass", Dimension::kMass, Limits::between(0.0, daq::kHeaviestWeight_kg));
    reading.voltage_V = point.quantity("voltage", Dimension::kVoltage, Limits::any());
    reading.standard_error_V =
        point.quantity_if_given("standard_error", Dimension::kVoltage, Limits::at_least(0.0));
    reading.wander_V = point.quantity_if_given("wander", Dimension::kVoltage, Limits::at_least(0.0));
    reading.saturated = point.boolean("saturated", false);
    weighed.readings.push_back(reading);
  }
  if (const Result<void> ok = settings->finish(); !ok) return tl::unexpected(ok.error());
  return weighed;
}

std::string readings_table(const std::vector<daq::WeighedPoint>& points) {
  io::Table table{{{.heading = "mass", .unit = "kg", .format = ".6g"},
                   {.heading = "force", .unit = "N", .format = ".6g"},
                   {.heading = "voltage", .unit = "V", .format = ".8g"},
                   {.heading = "standard error", .unit = "V", .format = ".2g"},
                   {.heading = "off the line", .unit = "V", .format = "+.3g"},
                   {.heading = "", .align = io::Table::Align::kLeft}}};
  for (const auto& [reading, force_N, residual_V, refused] : points) {
    table.add({reading.mass_kg, force_N, reading.voltage_V, io::cell(reading.standard_error_V), residual_V,
               refused.empty() ? "" : "does not count: " + refused});
  }
  return table.text();
}

/// What a technician says at the prompt.
enum class Answer { kRead, kUndo, kDone, kQuit, kNoMass };

/// \param mass_kg  of kRead. \param why  of kNoMass.
Answer answer_of(const std::string& typed, bool tare, double& mass_kg, std::string& why) {
  const std::string_view text = traces::trimmed(typed);
  if (text == "q" || text == "quit") return Answer::kQuit;
  if (tare) {
    mass_kg = 0.0;
    return Answer::kRead;
  }
  if (text == "done" || text.empty()) return Answer::kDone;
  if (text == "undo") return Answer::kUndo;
  // Weights are marked in g as well as in kg: a number alone would be a guess.
  const auto mass = base::enter_quantity(text, Dimension::kMass, base::BareNumber::kOnlyZero);
  if (!mass) {
    why = mass.error().message;
  } else if (!(mass->value >= 0.0 && mass->value <= daq::kHeaviestWeight_kg)) {
    why = fmt::format("{} kg; must be 0 to {} kg", mass->value, daq::kHeaviestWeight_kg);
  } else {
    mass_kg = mass->value;
    return Answer::kRead;
  }
  return Answer::kNoMass;
}

constexpr const char* kNextWeight =
    "Hang the next weight (first heavier ones, then down again the same way) and type its mass, such as 500 "
    "g;\n"
    "0 for nothing, undo to forget the last, done to compute, q to give up.\n> ";

Result<Weighed> ask(Weighing& weighing, double gravity_m_per_s2, const daq::WeighingTimes& times,
                    std::istream& answers, std::ostream& prompts) {
  Weighed weighed;
  weighed.gravity_m_per_s2 = gravity_m_per_s2;
  weighed.span_V = weighing.span_V();
  const daq::BoardInfo& board = weighing.board();
  fmt::print(prompts, "Load cell on {} {} {}, channel {}, {} to {} V.\n", board.driver,
             base::printable(board.board_name), base::printable(board.device), board.channel,
             board.range_min_V, board.range_max_V);
  for (;;) {
    const bool tare = weighed.readings.empty();
    prompts << (tare ? "Take everything off the load cell, hook and pan stay; then press Enter, or q.\n> "
                     : kNextWeight)
            << std::flush;
    std::string line;
    if (!std::getline(answers, line)) line = tare ? "q" : "done";
    double mass_kg = 0.0;
    std::string no_mass;
    switch (answer_of(line, tare, mass_kg, no_mass)) {
      case Answer::kQuit:
        return base::failure("given up: no calibration was made");
      case Answer::kUndo:
        weighed.readings.pop_back();
        continue;
      case Answer::kNoMass:
        fmt::print(prompts, "  that is no mass: {}\n", base::printable(no_mass));
        continue;
      case Answer::kDone: {
        const std::string why = weighed.result().fit.reason;
        if (why.empty() || !answers) return weighed;
        fmt::print(prompts, "  not yet: {}\n", why);
        continue;
      }
      case Answer::kRead:
        break;
    }
    const Result<daq::WeightReading> reading = weighing.read(mass_kg, times);
    if (!reading) return tl::unexpected(reading.error());
    weighed.readings.push_back(*reading);
    const daq::WeighedPoint point = weighed.result().points.back();
    fmt::print(prompts, "  {:.6g} kg, {:.6g} N: {:.8g} V{}\n", mass_kg, point.force_N, reading->voltage_V,
               point.refused.empty() ? "" : "; does not count: " + point.refused);
    // It stays in the list, for the record, but for the tare, without which nothing can be judged.
    if (tare && !point.refused.empty()) weighed.readings.pop_back();
  }
}

std::string text_of(const daq::WeighedCalibration& result, const io::KeptCalibration& kept,
                    const std::optional<daq::GainChange>& confirmed) {
  const io::StoredCalibration& stored = kept.stored;
  std::string text = readings_table(result.points);
  const daq::LoadCellFit& fit = result.fit;
  text += fmt::format("gain {:.8g} +- {:.2g} N/V, zero {:.6g} +- {:.2g} V, of {} readings\n",
                      stored.load_cell.gain_N_per_V, fit.gain_standard_error_N_per_V.value_or(std::nan("")),
                      stored.load_cell.zero_V, fit.zero_standard_error_V.value_or(std::nan("")), fit.used);
  text += fmt::format("off the line {:.2g} V, hysteresis {:+.2g} V\n", fit.residual_V.value_or(std::nan("")),
                      fit.hysteresis_V.value_or(std::nan("")));
  for (const base::Finding& finding : result.findings) text += io::finding_text(finding, "look: ");
  if (confirmed) text += fmt::format("look: {}; confirmed\n", daq::to_text(*confirmed));
  if (kept.before) {
    text += fmt::format("gain {:+.3g} % against that of {}\n",
                        100.0 * (stored.load_cell.gain_N_per_V / kept.before->load_cell.gain_N_per_V - 1.0),
                        kept.before->facts.date);
  }
  const std::string& expires = stored.facts.expires;
  return text + fmt::format("kept in {}, {}\n", kept.file.string(),
                            expires.empty() ? std::string{"valid for ever"} : "valid until " + expires);
}

std::string json_of(const daq::WeighedCalibration& result, const io::KeptCalibration& kept,
                    const std::optional<daq::GainChange>& confirmed) {
  const io::StoredCalibration& stored = kept.stored;
  std::vector<base::Finding> findings = result.findings;
  if (confirmed) base::add(findings, daq::finding(*confirmed));
  Json all{{"file", kept.file.string()},
           {"date", stored.facts.date},
           {"expires", stored.facts.expires},
           {"certificate", stored.facts.certificate},
           {"gain", stored.load_cell.gain_N_per_V},
           {"gain_standard_error", daemon::known_json(stored.facts.gain_standard_error_N_per_V)},
           {"zero", stored.load_cell.zero_V},
           {"zero_standard_error", daemon::known_json(stored.facts.zero_standard_error_V)},
           {"residual", daemon::known_json(stored.facts.residual_V)},
           {"hysteresis", daemon::known_json(stored.facts.hysteresis_V)},
           {"gain_change", daemon::gain_change_json(confirmed)},
           {"points", daemon::points_json(result)}};
  record::put_findings(findings, all);
  return io::json_document(all);
}

Result<Weighed> weigh_by(const CalibrateOptions& options, const std::optional<WeighingPlace>& place,
                         std::istream& answers, std::ostream& prompts) {
  if (!place) return read_points(options.points);
  const auto settle_s = number_of("--settle", options.settle, Dimension::kTime, true);
  if (!settle_s) return tl::unexpected(settle_s.error());
  const auto reading_s = number_of("--reading", options.reading, Dimension::kTime, true);
  if (!reading_s) return tl::unexpected(reading_s.error());
  Result<Weighing> weighing = Weighing::open(*place);
  if (!weighing) return tl::unexpected(weighing.error());
  return ask(*weighing, place->gravity_m_per_s2, {settle_s->value_or(0.0), reading_s->value_or(0.0)}, answers,
             prompts);
}

/// The gain that the daemon has now: of the latest calibration in `folder`, else by the configuration;
/// nothing if neither names one. Errors: as io::load_calibration().
Result<std::optional<double>> gain_in_use(const std::filesystem::path& folder,
                                          const std::optional<WeighingPlace>& place) {
  for (const std::filesystem::path& calibrations : {folder, place ? place->folder : folder}) {
    std::error_code error;
    const bool one = std::filesystem::is_regular_file(calibrations, error);
    if (!one && !io::holds_calibration(calibrations)) continue;
    const Result<io::StoredCalibration> latest = io::load_calibration(calibrations);
    if (!latest) return tl::unexpected(latest.error());
    return std::optional<double>{latest->load_cell.gain_N_per_V};
  }
  return place ? place->load_cell_gain_N_per_V : std::nullopt;
}

/// Whether a change of the gain is meant: by --confirm, or by the technician at the board.
bool confirmed_by(const CalibrateOptions& options, const daq::GainChange& change, std::istream& answers,
                  std::ostream& prompts) {
  if (options.confirm) return true;
  if (options.config.empty()) return false;
  fmt::print(prompts, "Look: {}.\nType yes to keep it all the same; anything else keeps nothing.\n> ",
             daq::to_text(change));
  prompts << std::flush;
  std::string line;
  return std::getline(answers, line) && traces::trimmed(line) == "yes";
}

/// \param answers  what the technician types. \param prompts  what is said in between.
/// Errors: kFailure if the readings give no calibration; nothing is kept then.
Result<std::string> run_calibrate(const CalibrateOptions& options, std::istream& answers,
                                  std::ostream& prompts) {
  if (options.config.empty() == options.points.empty()) {
    return base::usage_error("either --config with the board to read or --points with readings is needed");
  }
  const auto days = base::parse_number(options.valid_days);
  if (!days || !(*days >= 0.0) || !(*days <= io::kLongestValid_days)) {
    return base::usage_error("--valid-days {}: 0 (for ever) to {}", options.valid_days,
                             io::kLongestValid_days);
  }
  std::optional<WeighingPlace> place;
  if (!options.config.empty()) {
    auto loaded = load_weighing_place(options.config);
    if (!loaded) return tl::unexpected(loaded.error());
    place = *std::move(loaded);
  }
  std::filesystem::path folder = options.folder;
  if (folder.empty() && place) folder = place->folder;
  if (folder.empty()) {
    return base::usage_error("--folder is needed: where the calibrations are kept, or [tester] calibration");
  }
  const Result<Weighed> weighed = weigh_by(options, place, answers, prompts);
  if (!weighed) return tl::unexpected(weighed.error());
  const daq::WeighedCalibration result = weighed->result();
  if (!result.fit.load_cell) {
    prompts << readings_table(result.points);
    return base::failure("no calibration: {}", result.fit.reason);
  }
  const auto in_use = gain_in_use(folder, place);
  if (!in_use) return tl::unexpected(in_use.error());
  if (!*in_use) prompts << "No gain in use is known: the new one is not compared.\n";
  const auto change = daq::gain_change(result.fit.load_cell->gain_N_per_V, *in_use);
  if (change && !confirmed_by(options, *change, answers, prompts)) {
    prompts << readings_table(result.points);
    return base::failure("{}: {}; nothing was kept; if the change is meant, repeat with --confirm",
                         daq::kGainChangeCode, daq::to_text(*change));
  }
  const auto kept = io::keep_result(result, {options.certificate, *days}, folder,
                                    base::make_system_clock()->realtime_ns(), change);
  if (!kept) return tl::unexpected(kept.error());
  return options.json ? json_of(result, *kept, change) : text_of(result, *kept, change);
}

constexpr const char* kCalibrateExamples =
    R"(Hang known weights on the load cell: nothing first, then at least three, each heavier, then the same way down.
A straight line by least squares gives gain and zero with their standard errors. A reading that cannot count
(saturated, unstable, no change from the tare, less than 1 % of the range) is named with the reason. Each
calibration is a file of its own, named by its date, and stays as it is; [tester] calibration in the daemon's
configuration names the folder, and the latest goes into each record. A gain that differs from the one in use by
more than 20 % is kept only if somebody confirms it: by yes at the prompt, or with --confirm.

Examples:
  stickslip calibrate --config /etc/stickslip/stickslipd.toml --certificate "DKD-1234"
  stickslip calibrate --config stickslipd.toml --reading "2 s" --settle "5 s"
  stickslip calibrate --points readings.toml --folder calibrations --valid-days 180

A file of readings: [[point]] tables with mass = "500 g" and voltage = "1.25 V", the tare first; if known
standard_error and wander (volts), saturated = true.)";

}  // namespace

void add_calibrate(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<CalibrateOptions>();
  CLI::App* command = app.add_subcommand("calibrate", "find gain and zero of a load cell by known weights");
  command->footer(kCalibrateExamples);
  command->add_option("--config", options->config, "of the daemon, which must not run: its board is read")
      ->type_name("FILE.toml");
  command->add_option("--points", options->points, "readings made elsewhere instead")->type_name("FILE.toml");
  command->add_option("--folder", options->folder, "of the calibrations; else [tester] calibration")
      ->type_name("DIR");
  command->add_option("--certificate", options->certificate, "of the weights")->type_name("TEXT");
  command->add_option("--valid-days", options->valid_days, "until a new one is due; 0: for ever")
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--settle", options->settle, "left for a weight to come to rest, with unit")
      ->capture_default_str()
      ->type_name("T");
  command->add_option("--reading", options->reading, "for which each weight is read, with unit")
      ->capture_default_str()
      ->type_name("T");
  command->add_flag("--confirm", options->confirm,
                    "keep a gain that differs from the one in use by more than 20 %");
  command->add_flag("--json", options->json, "JSON instead of text");
  choose(*command, chosen, [options] { return run_calibrate(*options, std::cin, std::cerr); });
}

}  // namespace stickslip::cli
