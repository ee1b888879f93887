#include "report/plot/figure.hpp"

#include "report/plot/gnuplot.hpp"
#include "report/plot/script.hpp"

#include "core/base/contract.hpp"

namespace stickslip::plot {

base::Result<std::string> draw_svg(const Figure& figure) {
  constexpr int kSmallest_px = 200;
  constexpr int kLargest_px = 4000;
  STICKSLIP_EXPECTS(!figure.panels.empty());
  STICKSLIP_EXPECTS(figure.width_px >= kSmallest_px && figure.width_px <= kLargest_px);
  STICKSLIP_EXPECTS(figure.height_px >= kSmallest_px && figure.height_px <= kLargest_px);
  return run_gnuplot(gnuplot_script(figure));
}

}  // namespace stickslip::plot
