#include <fmt/format.h>

#include <string>
#include <string_view>

#include "cli/accuracy_report/accuracy_table.hpp"

#include "core/base/text.hpp"

namespace stickslip::accuracy_report {
namespace {

// Colours carry no meaning, so that the page can be printed in black.
constexpr std::string_view kStyle = R"(
body { font: 11pt/1.4 sans-serif; color: #000; background: #fff; max-width: 60em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; }
table { border-collapse: collapse; width: 100%; font-size: 0.9em; }
th, td { border-bottom: 1px solid #999; padding: 0.2em 0.6em; text-align: left; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
td.c, th.c { text-align: center; padding: 0.2em 0.1em; }
svg { width: 100%; height: auto; }
@media print { body { max-width: none; margin: 0; } table, svg { page-break-inside: avoid; } }
)";

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : base::printable_lines(text)) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '>':
        html += "&gt;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string motion_table(const AccuracyReport& report) {
  const std::optional<double> exact_ns = report.motion.exact_ns_per_scan();
  std::string html;
  for (std::size_t i = 0; i < report.motion.rows.size(); ++i) {
    const accuracy::MethodMeasurement& row = report.motion.rows[i];
    html += fmt::format("<tr><td>{}</td><td>{}</td>", escaped(row.method), escaped(row.setting));
    if (!row.lacks.empty()) {
      html += fmt::format("<td colspan=\"5\">cannot: {}</td></tr>\n", escaped(row.lacks));
      continue;
    }
    html += fmt::format(
        "<td class=\"n\">{}</td><td class=\"n\">{:.4g}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
        "<td>{}</td></tr>\n",
        row.largest_error ? fmt::format("{:.2g}", *row.largest_error) : "reference", row.ns_per_scan,
        exact_ns ? fmt::format("{:.3g}", row.ns_per_scan / *exact_ns) : "–", row.capture_count,
        grazing_words(report.grazing[i]));
  }
  return html;
}

std::string grazing_table(const AccuracyReport& report) {
  std::string html = "<tr><th>method</th><th>setting</th>";
  for (int n = 1; n <= accuracy::kFinestStep; ++n) html += fmt::format("<th class=\"c\">{}</th>", n);
  html += "</tr>\n";
  for (const accuracy::GrazingRow& row : report.grazing) {
    html += fmt::format("<tr><td>{}</td><td>{}</td>", escaped(row.method), escaped(row.setting));
    for (const accuracy::Grazing step : row.steps) {
      html += fmt::format("<td class=\"c\" title=\"{}\">{}</td>", accuracy::name(step), grazing_symbol(step));
    }
    html += "</tr>\n";
  }
  return html;
}

std::string detection_part(const AccuracyReport& report) {
  if (!report.no_detection.empty()) return "<p>" + escaped(report.no_detection) + "</p>";
  std::string html =
      "<table><tr><th>estimator</th><th class=\"n\">error of S − K</th><th class=\"n\">µs per cycle</th>"
      "<th></th></tr>\n";
  for (const accuracy::DetectionRow& row : report.detection) {
    html +=
        fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>\n",
                    escaped(row.estimator), row.error ? fmt::format("{:.2g}", *row.error) : "–",
                    row.us_per_cycle ? fmt::format("{:.4g}", *row.us_per_cycle) : "–", escaped(row.reason));
  }
  return html + "</table>";
}

std::string tier_part(const AccuracyReport& report) {
  std::string html =
      "<table><tr><th class=\"n\">scans/s</th><th>estimator</th><th class=\"n\">bias, %</th>"
      "<th class=\"n\">sd, %</th><th class=\"n\">× bound</th><th class=\"n\">µs per cycle</th></tr>\n";
  for (const accuracy::TierRow& row : report.tiers) {
    html +=
        fmt::format("<tr><td class=\"n\">{:.6g}</td><td>{}</td>", row.scan_rate_Hz, escaped(row.estimator));
    html += row.reason.empty()
                ? fmt::format(
                      "<td class=\"n\">{:.2f}</td><td class=\"n\">{:.2f}</td><td class=\"n\">{:.3g}</td>"
                      "<td class=\"n\">{:.4g}</td></tr>\n",
                      100.0 * row.bias, 100.0 * row.deviation, row.over_bound, row.us_per_cycle)
                : fmt::format("<td colspan=\"4\">{}</td></tr>\n", escaped(row.reason));
  }
  return html + "</table>";
}

}  // namespace

std::string accuracy_page(const AccuracyReport& report, std::string_view svg) {
  // A document of its own has a declaration, which has no place within a page.
  const std::size_t start = svg.find("<svg");
  const std::string_view picture = start == std::string_view::npos ? svg : svg.substr(start);
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>stickslip accuracy: "
      "{0}</title>\n"
      "<style>{1}</style>\n</head>\n<body>\n<h1>What accuracy costs in time: {0}</h1>\n<p>{2}</p>\n"
      "<p>{3} scans at {4} Hz, the motion alone, on {5}. Reference: {6}, ± {7:.1g}; captures {8}. "
      "Asked {9:.1g}: <code>stickslip simulate</code> takes {10}.</p>\n{11}\n"
      "<table>\n<tr><th>method</th><th>setting</th><th class=\"n\">error</th><th class=\"n\">ns per scan</th>"
      "<th class=\"n\">× exact</th><th class=\"n\">captures</th><th>capture near the "
      "threshold</th></tr>\n{12}</table>\n"
      "<h2>The decisive event</h2>\n<p>Q = Q<sub>th</sub>(1 ∓ 10<sup>−n</sup>) at γ/2ω = {13:.4g}. + the "
      "capture below "
      "the threshold is found; - missed; ! one above is found that is not there; x both wrong; ? undecided "
      "by its own account.</p>\n"
      "<table>\n{14}</table>\n<h2>Detection</h2>\n<p>S − K of this scene's test, with all its effects, "
      "against the "
      "truth.</p>\n{15}\n<p>S − K of single cycles, live, at several scan rates: "
      "{16}.</p>\n{17}\n</body>\n</html>\n",
      escaped(report.scene_name), kStyle, escaped(report.scene_description), report.scan_count,
      report.scan_rate_Hz, escaped(report.processor), escaped(report.motion.reference),
      report.motion.reference_uncertainty, report.motion.capture_count, report.asked_accuracy,
      escaped(report.chosen_method), picture, motion_table(report), report.grazing_gamma_over_2omega,
      grazing_table(report), detection_part(report), accuracy::kTierScene, tier_part(report));
}

}  // namespace stickslip::accuracy_report
