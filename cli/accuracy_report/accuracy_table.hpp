/// \file
/// What `stickslip accuracy` shows: a table for the terminal, JSON, a figure, and a page.
#pragma once

#include <string>
#include <string_view>

#include "cli/accuracy_report/accuracy.hpp"
#include "report/plot/figure.hpp"

namespace stickslip::accuracy_report {

/// + found, - missed, ! false, x reversed.
[[nodiscard]] char grazing_symbol(accuracy::Grazing grazing) noexcept;

/// In UTF-8.
[[nodiscard]] std::string accuracy_table(const AccuracyReport& report);

/// SI units; null where there is nothing.
[[nodiscard]] std::string accuracy_json(const AccuracyReport& report);

/// Error against time per simulated scan, both logarithmic; a curve for each method.
[[nodiscard]] plot::Figure accuracy_figure(const AccuracyReport& report);

/// One self-contained page, readable in print. \param svg  the figure, drawn.
[[nodiscard]] std::string accuracy_page(const AccuracyReport& report, std::string_view svg);

/// What became of the capture a hair below the threshold: "found to 1e-13", "found to 1e-2, then missed".
[[nodiscard]] std::string grazing_words(const accuracy::GrazingRow& row);

}  // namespace stickslip::accuracy_report
