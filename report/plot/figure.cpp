#include "report/plot/figure.hpp"

#include "report/plot/gnuplot.hpp"
#include "report/plot/script.hpp"

#include "core/base/contract.hpp"
#include "core/base/wording.hpp"

namespace stickslip::plot {

base::Result<std::string> draw_svg(const Figure& figure) { return draw(figure, PictureFormat::kSvg); }

base::Result<PictureFormat> format_of_file(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".svg" || ending == ".SVG") return PictureFormat::kSvg;
  if (ending == ".png" || ending == ".PNG") return PictureFormat::kPng;
  return base::usage_error("{}: a picture ends in .svg or .png, not in \"{}\"",
                           base::one_line(file.string(), 200), base::one_line(ending));
}

base::Result<std::string> draw(const Figure& figure, PictureFormat format) {
  constexpr int kSmallest_px = 200;
  constexpr int kLargest_px = 4000;
  STICKSLIP_EXPECTS(!figure.panels.empty());
  STICKSLIP_EXPECTS(figure.width_px >= kSmallest_px && figure.width_px <= kLargest_px);
  STICKSLIP_EXPECTS(figure.height_px >= kSmallest_px && figure.height_px <= kLargest_px);
  return run_gnuplot(gnuplot_script(figure, format));
}

}  // namespace stickslip::plot
