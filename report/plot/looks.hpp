/// \file
/// Colours, shapes and shades of figures. Colours after Okabe and Ito, Color Universal Design, 2008.
#pragma once

#include <array>
#include <cstddef>

#include "report/plot/figure.hpp"

namespace stickslip::plot {

/// In the order of Colour.
inline constexpr std::array<const char*, 7> kColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                     "#E69F00", "#56B4E9", "#000000"};
/// gnuplot's numbers of symbols: filled circle, square, triangle, diamond; the same, open.
inline constexpr std::array<int, 8> kShapes{7, 5, 9, 13, 6, 4, 8, 12};

[[nodiscard]] inline const char* colour_of(const Curve& curve, std::size_t order) {
  const std::size_t index = curve.colour ? static_cast<std::size_t>(*curve.colour) : order;
  return kColours.at(index % kColours.size());
}

[[nodiscard]] inline int shape_of(std::size_t order) { return kShapes.at(order % kShapes.size()); }

/// Shades of stick and slip; those of the pages are the same (report/colours.css).
inline constexpr const char* kStickShade = "#009E73";
inline constexpr const char* kSlipShade = "#CC79A7";

struct ShadeLook {
  const char* colour;
  double opacity;
  const char* label;  ///< Name in the legend.
};

/// Order in which shades are painted and listed in the legend.
inline constexpr std::array<Shade, 4> kShades{Shade::kWindow, Shade::kStick, Shade::kSlip, Shade::kSlack};

[[nodiscard]] constexpr ShadeLook look(Shade shade) {
  switch (shade) {
    case Shade::kStick:
      return {kStickShade, 0.16, "stick"};
    case Shade::kSlip:
      return {kSlipShade, 0.24, "slip"};
    case Shade::kSlack:
      return {"#999999", 0.30, "slack"};
    case Shade::kWindow:
      return {"#E69F00", 0.25, ""};
  }
  return {"#999999", 0.3, ""};
}

}  // namespace stickslip::plot
