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
};

constexpr const char* kScript = "text/javascript; charset=utf-8";
constexpr const char* kStyle = "text/css; charset=utf-8";

constexpr std::array<Asset, 8> kAssets{{
    {"/", "text/html; charset=utf-8", live_page::live_html},
    {"/page/live.css", kStyle, live_page::live_css},
    {"/page/uplot.css", kStyle, live_page::uplot_css},
    {"/page/live.js", kScript, live_page::live_js},
    {"/page/scope.js", kScript, live_page::scope_js},
    {"/page/tables.js", kScript, live_page::tables_js},
    {"/page/calibrate.js", kScript, live_page::calibrate_js},
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
      answer(std::move(reply));
      return;
    }
    api(request, std::move(answer));
  };
}

}  // namespace stickslip::daemon
