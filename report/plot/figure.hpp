/// \file
/// A picture of curves, as SVG, drawn by gnuplot.
///
///     Figure figure;
///     figure.title = "Error against time";
///     figure.x = {"time per scan (s)", true};
///     figure.panels = {{.y = {"error of the coefficient", true}}};
///     figure.panels[0].curves = {{"CVODE", times, errors, CurveStyle::kLineAndPoints}};
///     const base::Result<std::string> svg = draw_svg(figure);
///
/// The same figure gives the same text for one version of gnuplot: no date, no font of the machine. Colours
/// tell apart for everybody [Okabe and Ito, Color Universal Design, 2008]; where they repeat, shapes differ.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::plot {

/// from < to
struct AxisRange {
  double from = 0.0;
  double to = 1.0;
};

struct Axis {
  std::string label{};  ///< With its unit.
  bool log = false;     ///< Values that are not positive are then left out.
  /// Else from the curves and markers: all of x, y with a little room.
  std::optional<AxisRange> range{};
};

enum class CurveStyle { kLine, kPoints, kLineAndPoints, kDashed };

/// Okabe and Ito's colours but yellow, which white swallows.
enum class Colour { kBlue, kVermilion, kGreen, kPurple, kOrange, kSkyBlue, kBlack };

/// With more points than two for each column of pixels it is drawn by the lowest and the highest in each
/// column: the same picture, and a file of bounded size. That needs x in rising order.
struct Curve {
  std::string label{};  ///< In the legend; empty: not there.
  /// As many x as y. What is not finite interrupts the line.
  std::vector<double> x{};
  std::vector<double> y{};
  CurveStyle style = CurveStyle::kLine;
  std::optional<Colour> colour{};  ///< Else the next in order.
};

enum class Shade { kStick, kSlip, kSlack, kWindow };

/// Part of the x axis with a subtle background.
struct Band {
  double from = 0.0;
  double to = 0.0;
  Shade shade = Shade::kStick;
};

/// Words at a point.
struct Marker {
  double x = 0.0;
  double y = 0.0;
  std::string text{};
};

struct Panel {
  Axis y{};
  std::vector<Curve> curves{};
  std::vector<Band> bands{};
  std::vector<Marker> markers{};
  double height = 1.0;          ///< > 0, in proportion to the other panels.
  std::optional<Axis> own_x{};  ///< Else the figure's.
};

struct Figure {
  std::string title{};
  Axis x{};                        ///< Of all panels, one under the other.
  std::vector<Panel> panels{};     ///< At least one.
  std::vector<std::string> notes;  ///< Small lines below.
  int width_px = 900;              ///< 200 to 4000; so is the height.
  int height_px = 450;
};

/// The picture as a whole SVG document. All texts are taken literally.
/// Errors: kFailure if gnuplot is not installed (names the package) or fails.
[[nodiscard]] base::Result<std::string> draw_svg(const Figure& figure);

}  // namespace stickslip::plot
