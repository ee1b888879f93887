/// \file
/// The files of the report page, from report/; cmake/embed.cmake builds them into the program.
#pragma once

#include <string_view>

namespace stickslip::report {

[[nodiscard]] std::string_view report_html() noexcept;
[[nodiscard]] std::string_view colours_css() noexcept;
[[nodiscard]] std::string_view report_css() noexcept;
[[nodiscard]] std::string_view uncertain_js() noexcept;  ///< For the live page too.
[[nodiscard]] std::string_view charts_js() noexcept;
[[nodiscard]] std::string_view report_js() noexcept;

}  // namespace stickslip::report
