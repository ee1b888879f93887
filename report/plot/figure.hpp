/// \file
/// Figures of curves, drawn by gnuplot as SVG.
///
///     Figure figure;
///     figure.title = "Error against time";
///     figure.x = {"time per scan (s)", true};
///     figure.panels = {{.y = {"error of the coefficient", true}}};
///     figure.panels[0].curves = {{"CVODE", times, errors, CurveStyle::kLineAndPoints}};
///     const base::Result<std::string> svg = draw_svg(figure);
///
/// The output is reproducible for one version of gnuplot: it holds no date and no font of the machine.
/// Colours are distinguishable with colour blindness [Okabe and Ito, Color Universal Design, 2008]; if they
/// repeat, shapes differ.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"

namespace stickslip::plot {

/// A range of an axis; from < to.
struct AxisRange {
  double from = 0.0;
  double to = 1.0;
};

struct Axis {
  std::string label{};  ///< With its unit.
  bool log = false;     ///< Logarithmic; values that are not positive are omitted.
  /// Absent: the extent of curves and markers, for y with a margin.
  std::optional<AxisRange> range{};
};

enum class CurveStyle { kLine, kPoints, kLineAndPoints, kDashed };

/// Okabe and Ito's colours without yellow, which is invisible on white.
enum class Colour { kBlue, kVermilion, kGreen, kPurple, kOrange, kSkyBlue, kBlack };

/// A curve. If it has more than two points for each column of pixels, only the lowest and highest of each
/// column are drawn: the picture is the same and the file bounded. x must then be in rising order.
struct Curve {
  std::string label{};  ///< Name in the legend; empty: not in the legend.
  /// x and y have equal lengths. A non-finite value interrupts the line.
  std::vector<double> x{};
  std::vector<double> y{};
  CurveStyle style = CurveStyle::kLine;
  std::optional<Colour> colour{};  ///< Absent: the next colour in order.
};

enum class Shade { kStick, kSlip, kSlack, kWindow };

/// A part of the x axis with a shaded background.
struct Band {
  double from = 0.0;
  double to = 0.0;
  Shade shade = Shade::kStick;
};

/// A text at a point.
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
  double height = 1.0;          ///< Relative to the other panels; > 0.
  std::optional<Axis> own_x{};  ///< Absent: the x axis of the figure.
};

struct Figure {
  std::string title{};
  Axis x{};                        ///< Of all panels, which are stacked.
  std::vector<Panel> panels{};     ///< At least one.
  std::vector<std::string> notes;  ///< Lines of small text below the panels.
  int width_px = 900;              ///< 200 to 4000; so is the height.
  int height_px = 450;
};

enum class PictureFormat { kSvg, kPng };

/// By the ending of its name. Error: kUsage for an unknown one, with those that are known.
[[nodiscard]] base::Result<PictureFormat> format_of_file(const std::filesystem::path& file);

/// As draw_svg(), in that format; a PNG has one pixel for each of the figure.
[[nodiscard]] base::Result<std::string> draw(const Figure& figure, PictureFormat format);

/// Draws the figure as an SVG document; blocks while gnuplot runs. Texts have no markup. Errors: kFailure if
/// gnuplot is not installed (the message names the package) or fails.
[[nodiscard]] base::Result<std::string> draw_svg(const Figure& figure);

}  // namespace stickslip::plot
