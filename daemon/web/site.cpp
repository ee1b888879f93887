#include "daemon/web/site.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "daemon/control/reply.hpp"
#include "daemon/web/live_assets.hpp"

namespace stickslip::daemon {
namespace {

struct Asset {
  std::string_view path;
  const char* type;
  std::string text;
  const char* policy = "";  ///< As HttpReply has it.
};

/// A report draws with the script and style that stand in it. It gets no origin, so that nothing in it can
/// reach what the live page keeps.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-modals; default-src 'none'; script-src 'unsafe-inline'; style-src "
    "'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kStyle = "text/css; charset=utf-8";

std::vector<Asset> assets_with(const ChartLibrary& charts) {
  constexpr const char* kPage = "text/html; charset=utf-8";
  const auto text = [](std::string_view part) { return std::string{part}; };
  return {
      {"/", kPage, text(live_page::live_html())},
      {"/page/live.css", kStyle, text(live_page::live_css())},
      {"/page/uplot.css", kStyle, charts.style},
      {"/page/live.js", kScript, text(live_page::live_js())},
      {"/page/scope.js", kScript, text(live_page::scope_js())},
      {"/page/tables.js", kScript, text(live_page::tables_js())},
      {"/page/tare.js", kScript, text(live_page::tare_js())},
      {"/page/calibrate.js", kScript, text(live_page::calibrate_js())},
      {"/page/batch.js", kScript, text(live_page::batch_js())},
      {"/page/batches.js", kScript, text(live_page::batches_js())},
      {"/page/report", kPage, text(live_page::shown_html()), kReportPolicy},
      {"/page/uplot.js", kScript, charts.script},
  };
}

}  // namespace

HttpHandler make_site(HttpHandler api, const base::Result<ChartLibrary>& charts) {
  std::string why_not = charts ? "" : charts.error().message;
  return [api = std::move(api), assets = assets_with(charts.value_or(ChartLibrary{})),
          why_not = std::move(why_not)](const HttpRequest& request, HttpAnswer answer) {
    const std::string_view path = std::string_view{request.target}.substr(0, request.target.find('?'));
    for (const Asset& asset : assets) {
      if (asset.path != path || request.method != "GET") continue;
      if (!why_not.empty()) return answer(refusal(503, why_not));
      HttpReply reply{200, asset.text, {}};
      reply.content_type = asset.type;
      reply.content_policy = asset.policy;
      answer(std::move(reply));
      return;
    }
    api(request, std::move(answer));
  };
}

}  // namespace stickslip::daemon
