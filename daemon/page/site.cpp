#include "daemon/page/site.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/assets.hpp"

#include "daemon/page/live_assets.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::page {
namespace {

struct Asset {
  std::string_view path;
  const char* type;
  std::string text;
  const char* policy = "";  ///< As HttpReply::content_policy.
};

/// Content-Security-Policy of a report: inline script and style are allowed. The sandbox gives it no origin,
/// so that it cannot read the storage of the live page.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-modals; default-src 'none'; script-src 'unsafe-inline'; style-src "
    "'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kStyle = "text/css; charset=utf-8";

std::vector<Asset> assets_with(const report::ChartLibrary& charts) {
  constexpr const char* kPage = "text/html; charset=utf-8";
  const auto text = [](std::string_view part) { return std::string{part}; };
  return {
      {"/", kPage, text(live_html())},
      {"/page/colours.css", kStyle, text(report::colours_css())},
      {"/page/live.css", kStyle, text(live_css())},
      {"/page/uplot.css", kStyle, charts.style},
      {"/page/theme.js", kScript, text(theme_js())},
      {"/page/live.js", kScript, text(live_js())},
      {"/page/chart.js", kScript, text(chart_js())},
      {"/page/scope.js", kScript, text(scope_js())},
      {"/page/trace.js", kScript, text(trace_js())},
      {"/page/uncertain.js", kScript, text(report::uncertain_js())},
      {"/page/tables.js", kScript, text(tables_js())},
      {"/page/answer.js", kScript, text(answer_js())},
      {"/page/tare.js", kScript, text(tare_js())},
      {"/page/calibrate.js", kScript, text(calibrate_js())},
      {"/page/lease.js", kScript, text(lease_js())},
      {"/page/batch.js", kScript, text(batch_js())},
      {"/page/shown.js", kScript, text(shown_js())},
      {"/page/batches.js", kScript, text(batches_js())},
      {"/page/records.js", kScript, text(records_js())},
      {"/page/trend.js", kScript, text(trend_js())},
      {"/page/report", kPage, text(shown_html()), kReportPolicy},
      {"/page/uplot.js", kScript, charts.script},
  };
}

}  // namespace

daemon::HttpHandler make_site(daemon::HttpHandler api, const base::Result<report::ChartLibrary>& charts) {
  std::string why_not = charts ? "" : charts.error().message;
  return [api = std::move(api), assets = assets_with(charts.value_or(report::ChartLibrary{})),
          why_not = std::move(why_not)](const daemon::HttpRequest& request, daemon::HttpAnswer answer) {
    const std::string_view path = std::string_view{request.target}.substr(0, request.target.find('?'));
    for (const Asset& asset : assets) {
      if (asset.path != path || request.method != "GET") continue;
      if (!why_not.empty()) return answer(daemon::refusal(503, why_not));
      daemon::HttpReply reply{200, asset.text, {}};
      reply.content_type = asset.type;
      reply.content_policy = asset.policy;
      answer(std::move(reply));
      return;
    }
    api(request, std::move(answer));
  };
}

}  // namespace stickslip::page
