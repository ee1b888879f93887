/// \file
/// The parts of the pages, as they lie in daemon/web and in uPlot's package; built in by cmake/embed.cmake.
#pragma once

#include <string_view>

namespace stickslip::daemon::web {

[[nodiscard]] std::string_view report_html() noexcept;
[[nodiscard]] std::string_view report_css() noexcept;
[[nodiscard]] std::string_view charts_js() noexcept;
[[nodiscard]] std::string_view report_js() noexcept;
[[nodiscard]] std::string_view uplot_js() noexcept;
[[nodiscard]] std::string_view uplot_css() noexcept;
[[nodiscard]] std::string_view uplot_license() noexcept;

}  // namespace stickslip::daemon::web
