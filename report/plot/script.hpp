/// \file
/// Translates a figure into commands of gnuplot.
#pragma once

#include <string>

#include "report/plot/figure.hpp"

namespace stickslip::plot {

/// The complete script: layout, styles and data of the figure.
[[nodiscard]] std::string gnuplot_script(const Figure& figure, PictureFormat format);

}  // namespace stickslip::plot
