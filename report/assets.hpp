/// \file
/// The parts of the pages, as they lie in daemon/web; built in by cmake/embed.cmake.
#pragma once

#include <string_view>

namespace stickslip::report {

[[nodiscard]] std::string_view report_html() noexcept;
[[nodiscard]] std::string_view report_css() noexcept;
[[nodiscard]] std::string_view charts_js() noexcept;
[[nodiscard]] std::string_view report_js() noexcept;

}  // namespace stickslip::report
