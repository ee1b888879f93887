/// \file
/// A figure as commands of gnuplot.
#pragma once

#include <string>

#include "daemon/plot/figure.hpp"

namespace stickslip::daemon {

/// All of the figure: what is to be drawn, where, and the data themselves.
[[nodiscard]] std::string gnuplot_script(const Figure& figure);

}  // namespace stickslip::daemon
