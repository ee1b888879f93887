/// \file
/// A figure as commands of gnuplot.
#pragma once

#include <string>

#include "report/plot/figure.hpp"

namespace stickslip::plot {

/// All of the figure: what is to be drawn, where, and the data themselves.
[[nodiscard]] std::string gnuplot_script(const Figure& figure);

}  // namespace stickslip::plot
