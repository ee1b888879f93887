/// \file
/// The files of the live page, from daemon/page; cmake/embed.cmake builds them into the program.
#pragma once

#include <string_view>

namespace stickslip::page {

[[nodiscard]] std::string_view live_html() noexcept;
[[nodiscard]] std::string_view live_css() noexcept;
[[nodiscard]] std::string_view theme_js() noexcept;
[[nodiscard]] std::string_view live_js() noexcept;
[[nodiscard]] std::string_view chart_js() noexcept;
[[nodiscard]] std::string_view scope_js() noexcept;
[[nodiscard]] std::string_view trace_js() noexcept;
[[nodiscard]] std::string_view tables_js() noexcept;
[[nodiscard]] std::string_view answer_js() noexcept;
[[nodiscard]] std::string_view tare_js() noexcept;
[[nodiscard]] std::string_view calibrate_js() noexcept;
[[nodiscard]] std::string_view lease_js() noexcept;
[[nodiscard]] std::string_view batch_js() noexcept;
[[nodiscard]] std::string_view shown_js() noexcept;
[[nodiscard]] std::string_view batches_js() noexcept;
[[nodiscard]] std::string_view records_js() noexcept;
[[nodiscard]] std::string_view trend_js() noexcept;
[[nodiscard]] std::string_view shown_html() noexcept;

}  // namespace stickslip::page
