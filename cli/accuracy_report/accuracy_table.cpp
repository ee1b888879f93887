#include "cli/accuracy_report/accuracy_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "io/json_text.hpp"
#include "io/or_null.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::accuracy_report {
namespace {

using accuracy::Grazing;
using accuracy::GrazingRow;
using accuracy::MethodMeasurement;
using Json = nlohmann::ordered_json;

constexpr std::string_view kAbsent = "–";

std::string number(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}g}", *value, digits) : std::string{kAbsent};
}

/// No double is nearer to the truth than this; so that nothing is "more exact" by chance.
double shown_error(double error) { return std::fmax(error, std::numeric_limits<double>::epsilon() / 8.0); }

std::string motion_rows(const AccuracyReport& report) {
  const std::optional<double> exact_ns = report.motion.exact_ns_per_scan();
  std::string text = fmt::format("{:<30} {:<22} {:>10} {:>10} {:>8} {:>9}  {}\n", "method", "setting",
                                 "error", "ns/scan", "× exact", "captures", "capture near the threshold");
  for (std::size_t i = 0; i < report.motion.rows.size(); ++i) {
    const MethodMeasurement& row = report.motion.rows[i];
    if (!row.lacks.empty()) {
      text += fmt::format("{:<30} {:<22} {:>10}  cannot: {}\n", row.method, row.setting, kAbsent, row.lacks);
      continue;
    }
    const std::string error = row.largest_error ? number(row.largest_error, 2) : "reference";
    const std::optional<double> factor =
        exact_ns ? std::optional<double>{row.ns_per_scan / *exact_ns} : std::nullopt;
    text +=
        fmt::format("{:<30} {:<22} {:>10} {:>10.4g} {:>8} {:>9}  {}\n", row.method, row.setting, error,
                    row.ns_per_scan, number(factor, 3), row.capture_count, grazing_words(report.grazing[i]));
  }
  return text;
}

std::string grazing_rows(const AccuracyReport& report) {
  std::string text = fmt::format("{:<30} {:<22}  n =", "method", "setting");
  for (int n = 1; n <= accuracy::kFinestStep; ++n) text += fmt::format("{:>3}", n);
  text += '\n';
  for (const GrazingRow& row : report.grazing) {
    text += fmt::format("{:<30} {:<22}     ", row.method, row.setting);
    for (const Grazing step : row.steps) text += fmt::format("  {}", grazing_symbol(step));
    text += '\n';
  }
  return text;
}

std::string detection_rows(const AccuracyReport& report) {
  if (!report.no_detection.empty()) return report.no_detection + "\n";
  std::string text = fmt::format("{:<53} {:>10} {:>10}\n", "estimator", "error", "µs/cycle");
  for (const accuracy::DetectionRow& row : report.detection) {
    const std::string why = row.reason.empty() ? std::string{} : "  " + row.reason;
    text += fmt::format("{:<53} {:>10} {:>10}{}\n", row.estimator, number(row.error, 2),
                        number(row.us_per_cycle, 4), why);
  }
  return text;
}

std::string tier_rows(const AccuracyReport& report) {
  std::string text = fmt::format("{:>10} {:>8}  {:<24} {:>9} {:>9} {:>8} {:>10}\n", "scans/s", "a cycle",
                                 "estimator", "bias, %", "sd, %", "× bound", "µs/cycle");
  for (const accuracy::TierRow& row : report.tiers) {
    text += fmt::format("{:>10.6g} {:>8.3g}  {:<24} ", row.scan_rate_Hz, row.scans_per_cycle, row.estimator);
    if (row.reason.empty()) {
      text += fmt::format("{:>9.2f} {:>9.2f} {:>8.3g} {:>10.4g}\n", 100.0 * row.bias, 100.0 * row.deviation,
                          row.over_bound, row.us_per_cycle);
    } else {
      text += row.reason + '\n';
    }
  }
  return text;
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
      motion_rows(report), report.grazing_gamma_over_2omega, grazing_rows(report), detection_rows(report),
      accuracy::kTierScene, tier_rows(report));
}

std::string accuracy_json(const AccuracyReport& report) {
  Json methods = Json::array();
  for (std::size_t i = 0; i < report.motion.rows.size(); ++i) {
    const MethodMeasurement& row = report.motion.rows[i];
    Json grazing = Json::array();
    for (const Grazing step : report.grazing[i].steps) grazing.push_back(accuracy::name(step));
    const bool measured = row.lacks.empty();
    methods.push_back({{"method", row.method},
                       {"setting", row.setting},
                       {"cannot", measured ? Json(nullptr) : Json(row.lacks)},
                       {"largest_error", io::or_null(row.largest_error)},
                       {"ns_per_scan", measured ? Json(row.ns_per_scan) : Json(nullptr)},
                       {"captures", measured ? Json(row.capture_count) : Json(nullptr)},
                       {"grazing", std::move(grazing)}});
  }
  Json tiers = Json::array();
  for (const accuracy::TierRow& row : report.tiers) {
    const bool measured = row.reason.empty();
    tiers.push_back({{"scan_rate", row.scan_rate_Hz},
                     {"estimator", row.estimator},
                     {"bias", measured ? Json(row.bias) : Json(nullptr)},
                     {"deviation", measured ? Json(row.deviation) : Json(nullptr)},
                     {"over_bound", measured ? Json(row.over_bound) : Json(nullptr)},
                     {"us_per_cycle", measured ? Json(row.us_per_cycle) : Json(nullptr)},
                     {"reason", measured ? Json(nullptr) : Json(row.reason)}});
  }
  Json estimators = Json::array();
  for (const accuracy::DetectionRow& row : report.detection) {
    estimators.push_back({{"estimator", row.estimator},
                          {"setting", row.setting},
                          {"error", io::or_null(row.error)},
                          {"us_per_cycle", io::or_null(row.us_per_cycle)},
                          {"reason", row.reason.empty() ? Json(nullptr) : Json(row.reason)}});
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
                  {"estimators", std::move(estimators)},
                  {"live_estimators", std::move(tiers)}};
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
