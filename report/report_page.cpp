#include "report/report_page.hpp"

#include <fmt/format.h>

#include <array>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <utility>

#include "io/json_text.hpp"
#include "report/assets.hpp"
#include "report/report_json.hpp"
#include <nlohmann/json.hpp>

#include "core/base/digits.hpp"
#include "core/base/version.hpp"

namespace stickslip::report {
namespace {

using Json = nlohmann::ordered_json;

Json quantities_json() {
  Json json = Json::array();
  for (const analysis::Quantity& quantity : analysis::quantities()) {
    json.push_back({{"name", quantity.name},
                    {"title", quantity.title},
                    {"label", quantity.in_full},
                    {"of_model", quantity.of_model},
                    {"unit", quantity.unit},
                    {"decimals", quantity.decimals}});
  }
  return json;
}

/// \param report  report_json() of the material.
Json material_json(const Material& material, Json report) {
  report["label"] = material.label;
  return report;
}

/// An element for each test: a browser parses only the traces that are looked at.
std::string trace_elements(std::initializer_list<const Material*> materials) {
  std::string html;
  std::size_t m = 0;
  constexpr std::size_t kRoomForTags = 100;
  std::size_t size = 0;
  for (const Material* const material : materials)
    for (const ReportedTest& test : material->tests) size += test.trace.size() + kRoomForTags;
  html.reserve(size);
  for (const Material* const material : materials) {
    std::size_t i = 0;
    for (const ReportedTest& test : material->tests)
      fmt::format_to(std::back_inserter(html),
                     "<script type=\"application/json\" id=\"trace-{}-{}\">{}</script>\n", m, i++,
                     test.trace);
    ++m;
  }
  return html;
}

/// Replaces each mark in the template once, in order.
std::string page_of(const Json& data, std::initializer_list<const Material*> materials,
                    const ChartLibrary& charts) {
  const std::string text = json_for_script(data);
  const std::string traces = trace_elements(materials);
  const std::array<std::pair<std::string_view, std::string_view>, 10> parts{{
      {"@LICENSE@", charts.license},
      {"@UPLOT_CSS@", charts.style},
      {"@COLOURS_CSS@", colours_css()},
      {"@REPORT_CSS@", report_css()},
      {"@DATA@", text},
      {"@TRACES@", traces},
      {"@UPLOT_JS@", charts.script},
      {"@UNCERTAIN_JS@", uncertain_js()},
      {"@CHARTS_JS@", charts_js()},
      {"@REPORT_JS@", report_js()},
  }};
  const std::string_view html = report_html();
  std::string page;
  page.reserve(html.size() + text.size() + traces.size() + charts.script.size());
  std::size_t done = 0;
  for (const auto& [mark, part] : parts) {
    const std::size_t at = html.find(mark, done);
    page.append(html.substr(done, at - done)).append(part);
    done = at + mark.size();
  }
  return page.append(html.substr(done));
}

/// The unit of the axis of speeds: that in which the first known one is shown.
Json speed_unit_json(const Json& materials) {
  for (const Json& material : materials) {
    for (const Json& group : material["groups"]) {
      const Json& speed = group["pull_speed"];
      if (!speed.is_number()) continue;
      const base::SpeedUnit unit = base::unit_of_speed(speed.get<double>());
      return {{"symbol", unit.symbol}, {"m_per_s", unit.m_per_s}};
    }
  }
  return {{"symbol", "m/s"}, {"m_per_s", 1.0}};
}

Json page_json(Json materials, Json comparison) {
  return {{"program", fmt::format("stickslip {} ({})", base::kVersion, base::kCommit)},
          {"quantities", quantities_json()},
          {"speed_unit", speed_unit_json(materials)},
          {"materials", std::move(materials)},
          {"comparison", std::move(comparison)}};
}

}  // namespace

std::string json_for_script(const Json& json) {
  const std::string whole = io::json_text(json);
  std::string text;
  for (std::string_view rest = whole;;) {
    const std::size_t at = rest.find('<');
    text += rest.substr(0, at);
    if (at == rest.npos) return text;
    text += "\\u003c";  // Only inside strings, where this means the same.
    rest.remove_prefix(at + 1);
  }
}

std::string report_page(const Material& material, const ChartLibrary& charts) {
  return page_of(page_json(Json::array({material_json(material, report_json(material))}), nullptr),
                 {&material}, charts);
}

std::string comparison_page(const Material& a, const Material& b, const MaterialComparison& comparison,
                            const ChartLibrary& charts) {
  Json whole = comparison_json(a, b, comparison);
  Json materials =
      Json::array({material_json(a, std::move(whole["a"])), material_json(b, std::move(whole["b"]))});
  whole.erase("a");
  whole.erase("b");
  return page_of(page_json(std::move(materials), std::move(whole)), {&a, &b}, charts);
}

}  // namespace stickslip::report
