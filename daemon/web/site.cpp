#include "daemon/web/site.hpp"

#include <array>
#include <string_view>
#include <utility>

#include "daemon/web/live_assets.hpp"

namespace stickslip::daemon {
namespace {

struct Asset {
  std::string_view path;
  const char* type;
  std::string_view (*text)() noexcept;
  const char* policy = "";  ///< As HttpReply has it.
};

/// A report draws with the script and style that stand in it. It gets no origin, so that nothing in it can
/// reach what the live page keeps.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts allow-modals; default-src 'none'; script-src 'unsafe-inline'; style-src "
    "'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kStyle = "text/css; charset=utf-8";

constexpr std::array<Asset, 12> kAssets{{
    {"/", "text/html; charset=utf-8", live_page::live_html},
    {"/page/live.css", kStyle, live_page::live_css},
    {"/page/uplot.css", kStyle, live_page::uplot_css},
    {"/page/live.js", kScript, live_page::live_js},
    {"/page/scope.js", kScript, live_page::scope_js},
    {"/page/tables.js", kScript, live_page::tables_js},
    {"/page/tare.js", kScript, live_page::tare_js},
    {"/page/calibrate.js", kScript, live_page::calibrate_js},
    {"/page/batch.js", kScript, live_page::batch_js},
    {"/page/batches.js", kScript, live_page::batches_js},
    {"/page/report", "text/html; charset=utf-8", live_page::shown_html, kReportPolicy},
    {"/page/uplot.js", kScript, live_page::uplot_js},
}};

}  // namespace

HttpHandler make_site(HttpHandler api) {
  return [api = std::move(api)](const HttpRequest& request, HttpAnswer answer) {
    const std::string_view path = std::string_view{request.target}.substr(0, request.target.find('?'));
    for (const Asset& asset : kAssets) {
      if (asset.path != path || request.method != "GET") continue;
      HttpReply reply{200, std::string{asset.text()}, {}};
      reply.content_type = asset.type;
      reply.content_policy = asset.policy;
      answer(std::move(reply));
      return;
    }
    api(request, std::move(answer));
  };
}

}  // namespace stickslip::daemon
