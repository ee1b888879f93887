#include "cli/accuracy_report/accuracy_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::accuracy_report {
namespace {

using accuracy::Grazing;
using accuracy::GrazingRow;
using accuracy::MethodMeasurement;
using Json = nlohmann::ordered_json;
using io::Table;

constexpr auto kLeft = Table::Align::kLeft;

/// No double is nearer to the truth than this; so that nothing is "more exact" by chance.
double shown_error(double error) { return std::fmax(error, std::numeric_limits<double>::epsilon() / 8.0); }

Table measured_methods(const AccuracyReport& report) {
  const std::optional<double> exact_ns = report.motion.exact_ns_per_scan();
  Table table{{{.name = "method", .heading = "method", .align = kLeft},
               {.name = "setting", .heading = "setting", .align = kLeft},
               {.name = "cannot"},
               {.name = "largest_error"},
               {.heading = "error"},
               {.name = "ns_per_scan", .heading = "ns/scan", .format = ".4g"},
               {.heading = "× exact", .format = ".3g"},
               {.name = "captures", .heading = "captures"},
               {.heading = "capture near the threshold", .align = kLeft}}};
  for (std::size_t i = 0; i < report.motion.rows.size(); ++i) {
    const MethodMeasurement& row = report.motion.rows[i];
    if (!row.lacks.empty()) {
      table.add({row.method, row.setting, row.lacks, {}, {}, {}, {}, {}, "cannot: " + row.lacks});
      continue;
    }
    table.add({row.method,
               row.setting,
               {},
               io::cell(row.largest_error),
               row.largest_error ? fmt::format("{:.2g}", *row.largest_error) : "reference",
               row.ns_per_scan,
               io::cell(exact_ns ? std::optional{row.ns_per_scan / *exact_ns} : std::nullopt),
               row.capture_count,
               grazing_words(report.grazing[i])});
  }
  return table;
}

std::string grazing_rows(const AccuracyReport& report) {
  std::vector<Table::Column> columns{{.heading = "method", .align = kLeft},
                                     {.heading = "setting", .align = kLeft},
                                     {.heading = "n =", .align = kLeft}};
  for (int n = 1; n <= accuracy::kFinestStep; ++n) columns.push_back({.heading = fmt::format("{}", n)});
  Table table{std::move(columns)};
  for (const GrazingRow& row : report.grazing) {
    std::vector<Table::Cell> cells{row.method, row.setting, ""};
    for (const Grazing step : row.steps) cells.emplace_back(std::string{grazing_symbol(step)});
    table.add(std::move(cells));
  }
  return table.text();
}

Table measured_estimators(const AccuracyReport& report) {
  Table table{{{.name = "estimator", .heading = "estimator", .align = kLeft},
               {.name = "setting"},
               {.name = "error", .heading = "error", .format = ".2g"},
               {.name = "us_per_cycle", .heading = "µs/cycle", .format = ".4g"},
               {.name = "reason", .heading = "", .align = kLeft}}};
  for (const accuracy::DetectionRow& row : report.detection) {
    table.add({row.estimator, row.setting, io::cell(row.error), io::cell(row.us_per_cycle),
               row.reason.empty() ? Table::Cell{} : row.reason});
  }
  return table;
}

Table measured_live_estimators(const AccuracyReport& report) {
  Table table{{{.name = "scan_rate", .heading = "scans/s", .format = ".6g"},
               {.heading = "a cycle", .format = ".3g"},
               {.name = "estimator", .heading = "estimator", .align = kLeft},
               {.name = "bias"},
               {.heading = "bias, %", .format = ".2f"},
               {.name = "deviation"},
               {.heading = "sd, %", .format = ".2f"},
               {.name = "over_bound", .heading = "× bound", .format = ".3g"},
               {.name = "us_per_cycle", .heading = "µs/cycle", .format = ".4g"},
               {.name = "reason", .heading = "", .align = kLeft}}};
  for (const accuracy::TierRow& row : report.tiers) {
    if (row.reason.empty()) {
      table.add({row.scan_rate_Hz, row.scans_per_cycle, row.estimator, row.bias, 100.0 * row.bias,
                 row.deviation, 100.0 * row.deviation, row.over_bound, row.us_per_cycle});
    } else {
      table.add({row.scan_rate_Hz, row.scans_per_cycle, row.estimator, {}, {}, {}, {}, {}, {}, row.reason});
    }
  }
  return table;
}

}  // namespace

char grazing_symbol(Grazing grazing) noexcept {
  switch (grazing) {
    case Grazing::kFound:
      return '+';
    case Grazing::kMissed:
      return '-';
    case Grazing::kFalse:
      return '!';
    case Grazing::kReversed:
      return 'x';
    case Grazing::kUndecided:
      return '?';
  }
  return '?';
}

std::string grazing_words(const GrazingRow& row) {
  const auto first_wrong =
      std::find_if(row.steps.begin(), row.steps.end(), [](Grazing step) { return step != Grazing::kFound; });
  const auto found = first_wrong - row.steps.begin();
  if (first_wrong == row.steps.end()) return fmt::format("found to 1e-{}", found);
  const std::string_view then = accuracy::name(*first_wrong);
  return found == 0 ? std::string{then} : fmt::format("found to 1e-{}, then {}", found, then);
}

std::string accuracy_table(const AccuracyReport& report) {
  const accuracy::MotionComparison& motion = report.motion;
  return fmt::format(
      "{}: {} scans at {} Hz, the motion alone; {}\n"
      "reference: {}, ± {:.1g}; captures {}\n"
      "asked {:.1g}: simulate takes {}\n\n"
      "{}\n"
      "Q = Q_th(1 ∓ 10⁻ⁿ) at γ/2ω = {:.4g}: + capture below found, - missed, ! one found above that is not "
      "there, "
      "x both wrong, ? undecided\n{}\n"
      "S − K of this scene's test, with all its effects: error against the truth, and time\n{}\n"
      "S − K of single cycles, live, at several scan rates: {}\n{}",
      report.scene_name, report.scan_count, report.scan_rate_Hz, report.processor, motion.reference,
      motion.reference_uncertainty, motion.capture_count, report.asked_accuracy, report.chosen_method,
      measured_methods(report).text(), report.grazing_gamma_over_2omega, grazing_rows(report),
      report.no_detection.empty() ? measured_estimators(report).text() : report.no_detection + "\n",
      accuracy::kTierScene, measured_live_estimators(report).text());
}

std::string accuracy_json(const AccuracyReport& report) {
  Json methods = measured_methods(report).json();
  for (std::size_t i = 0; i < methods.size(); ++i) {
    Json& grazing = methods[i]["grazing"] = Json::array();
    for (const Grazing step : report.grazing[i].steps) grazing.push_back(accuracy::name(step));
  }
  const Json json{{"scene", report.scene_name},
                  {"scan_count", report.scan_count},
                  {"scan_rate", report.scan_rate_Hz},
                  {"processor", report.processor},
                  {"accuracy", report.asked_accuracy},
                  {"method", report.chosen_method},
                  {"reference",
                   {{"name", report.motion.reference},
                    {"uncertainty", io::or_null(report.motion.reference_uncertainty)},
                    {"captures", report.motion.capture_count}}},
                  {"methods", std::move(methods)},
                  {"grazing_gamma_over_2omega", report.grazing_gamma_over_2omega},
                  {"estimators", measured_estimators(report).json()},
                  {"live_estimators", measured_live_estimators(report).json()}};
  return io::json_document(json);
}

plot::Figure accuracy_figure(const AccuracyReport& report) {
  plot::Figure figure;
  figure.title = report.scene_name + ": error against time";
  figure.x = {"time per simulated scan (ns)", true};
  plot::Panel panel;
  panel.y = {"largest error of the coefficient", true};
  for (const MethodMeasurement& row : report.motion.rows) {
    if (!row.lacks.empty() || !row.largest_error || !std::isfinite(*row.largest_error)) continue;
    if (panel.curves.empty() || panel.curves.back().label != row.method) {
      panel.curves.push_back({row.method, {}, {}, plot::CurveStyle::kLineAndPoints});
    }
    panel.curves.back().x.push_back(row.ns_per_scan);
    panel.curves.back().y.push_back(shown_error(*row.largest_error));
  }
  figure.panels.push_back(std::move(panel));
  figure.notes = {
      fmt::format("{} scans at {} Hz; reference: {}, ± {:.1g}", report.scan_count, report.scan_rate_Hz,
                  report.motion.reference, report.motion.reference_uncertainty),
      report.processor};
  figure.height_px = 560;
  return figure;
}

}  // namespace stickslip::accuracy_report
