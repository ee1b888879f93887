#include "report/plot/script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

#include "report/plot/looks.hpp"
#include "report/plot/ranges.hpp"
#include "report/plot/thinning.hpp"

#include "core/base/text.hpp"

namespace stickslip::plot {
namespace {

// The page, in pixels.
constexpr int kLeft = 84;
constexpr int kRight = 24;
constexpr int kEdge = 8;
constexpr int kTitle = 40;
constexpr int kLegendRow = 20;
constexpr int kLegendSample = 26;
constexpr int kLegendGap = 22;
constexpr int kTicks = 32;      ///< Height of the numbers under an x axis.
constexpr int kAxisLabel = 20;  ///< Height of its label.
constexpr int kBetween = 14;
constexpr int kNoteRow = 17;
constexpr int kLeastPanel = 40;
constexpr double kCharacter = 7.2;  ///< Width of a character, px: an upper estimate of the mean.
constexpr double kTickDistance = 27.0;

/// A text in single quotes, in which gnuplot expands nothing; quotes are doubled.
std::string gnuplot_text(std::string_view text) {
  std::string out = "'";
  for (const char c : base::printable(text)) {
    out += c;
    if (c == '\'') out += '\'';
  }
  return out + "'";
}

/// Number of characters: all bytes except continuation bytes of UTF-8.
std::size_t length(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// A panel with its ranges and lines computed.
struct PreparedPanel {
  struct Line {
    const Curve* curve = nullptr;
    std::size_t order = 0;
    std::vector<Polyline> pieces{};
  };
  /// Position of an entry of the legend: from the left, and row.
  struct Entry {
    std::string label{};
    double x_px = 0.0;
    int row = 0;
    const Line* line = nullptr;  ///< Null: the entry is a shade.
    Shade shade = Shade::kStick;
  };
  const Panel* panel = nullptr;
  const Axis* x = nullptr;
  bool ticks_below = false;
  bool panel_follows = false;
  AxisRange x_range{};
  AxisRange y_range{};
  std::vector<Line> lines{};
  std::vector<Band> bands{};  ///< The bands in view, clipped to it.
  std::vector<Entry> legend{};
  int legend_rows = 0;

  [[nodiscard]] int above_px() const { return legend_rows == 0 ? 0 : legend_rows * kLegendRow + kEdge; }
  [[nodiscard]] int below_px() const {
    if (!ticks_below) return kBetween;
    return kTicks + (x->label.empty() ? 0 : kAxisLabel) + (panel_follows ? kBetween : 0);
  }
};

class Script {
 public:
  Script(const Figure& figure, PictureFormat format) : figure_(figure), format_(format) {
    std::set<Shade> explained;
    for (std::size_t i = 0; i < figure.panels.size(); ++i) panels_.push_back(prepared(i));
    for (PreparedPanel& panel : panels_) write_legend_of(panel, explained);
  }

  std::string terminal() const {
    if (format_ == PictureFormat::kPng) {
      return fmt::format(
          "set terminal pngcairo size {},{} enhanced font 'sans-serif,10' background rgb 'white'",
          figure_.width_px, figure_.height_px);
    }
    return fmt::format(
        "set terminal svg size {},{} fixed enhanced font 'sans-serif,13' background rgb 'white' "
        "name 'stickslip'",
        figure_.width_px, figure_.height_px);
  }

  std::string write() {
    add("set encoding utf8\n"
        "{}\n"
        "set minussign\nset multiplot\nunset key\nset border 3 lc rgb '#555555'\n"
        "set tics nomirror out scale 0.6 textcolor rgb '#222222'\n"
        "set grid lt 1 lc rgb '#dddddd' lw 0.6\n",
        terminal());
    add("set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n", across(kLeft), across(right_px()));

    const int above = figure_.title.empty() ? kEdge : kTitle;
    const int notes = kNoteRow * static_cast<int>(figure_.notes.size()) + kEdge;
    int taken = above + notes;
    double shares = 0.0;
    for (const PreparedPanel& panel : panels_) {
      taken += panel.above_px() + panel.below_px();
      shares += panel.panel->height;
    }
    const double free = std::max(figure_.height_px - taken, kLeastPanel);

    write_page_texts(notes);
    double top = above;
    for (const PreparedPanel& panel : panels_) {
      write_legend(panel, top);
      top += panel.above_px();
      const double bottom = top + free * panel.panel->height / shares;
      write_panel(panel, top, bottom);
      add("unset label\nunset object\nunset arrow\n");
      top = bottom + panel.below_px();
    }
    add("unset multiplot\n");
    return std::move(text_);
  }

 private:
  template <typename... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
  }
  [[nodiscard]] int right_px() const { return figure_.width_px - kRight; }
  [[nodiscard]] double across(double x_px) const { return x_px / figure_.width_px; }
  [[nodiscard]] double up(double from_top_px) const { return 1.0 - from_top_px / figure_.height_px; }

  [[nodiscard]] PreparedPanel prepared(std::size_t index) const {
    const Panel& panel = figure_.panels[index];
    PreparedPanel out;
    out.panel = &panel;
    out.x = panel.own_x ? &*panel.own_x : &figure_.x;
    out.panel_follows = index + 1 < figure_.panels.size();
    out.ticks_below = panel.own_x.has_value() || !out.panel_follows;
    std::vector<const Panel*> sharing;
    for (const Panel& other : figure_.panels) {
      if (panel.own_x ? &other == &panel : !other.own_x) sharing.push_back(&other);
    }
    out.x_range = x_range_of(*out.x, sharing);
    out.y_range = y_range_of(panel, out.x_range);
    const auto columns = static_cast<std::size_t>(right_px() - kLeft);
    for (std::size_t i = 0; i < panel.curves.size(); ++i) {
      out.lines.push_back({&panel.curves[i], i,
                           visible_pieces(panel.curves[i], out.x_range, out.x->log, panel.y.log, columns)});
    }
    const double seam = (out.x_range.to - out.x_range.from) / static_cast<double>(2 * columns);
    for (const Band& band : panel.bands) {
      const double from = std::max(band.from, out.x_range.from);
      const double to = std::min(band.to, out.x_range.to);
      if (!(from < to)) continue;
      // Two that touch, to half a pixel, would show a seam.
      if (!out.bands.empty() && out.bands.back().shade == band.shade && from - out.bands.back().to < seam) {
        out.bands.back().to = to;
      } else {
        out.bands.push_back({from, to, band.shade});
      }
    }
    return out;
  }

  /// Lays out the legend from left to right, row by row. Each shade has one entry in the figure.
  void write_legend_of(PreparedPanel& panel, std::set<Shade>& explained) const {
    double x = kLeft;
    const auto place = [&](PreparedPanel::Entry entry) {
      const double width = kLegendSample + kCharacter * static_cast<double>(length(entry.label));
      if (panel.legend_rows == 0) panel.legend_rows = 1;
      if (x > kLeft && x + width > right_px()) {
        x = kLeft;
        ++panel.legend_rows;
      }
      entry.x_px = x;
      entry.row = panel.legend_rows - 1;
      x += width + kLegendGap;
      panel.legend.push_back(std::move(entry));
    };
    for (const PreparedPanel::Line& line : panel.lines) {
      if (line.curve->label.empty() || line.pieces.empty()) continue;
      place({.label = line.curve->label, .line = &line});
    }
    for (const Shade shade : kShades) {
      const bool there = std::any_of(panel.bands.begin(), panel.bands.end(),
                                     [shade](const Band& band) { return band.shade == shade; });
      const std::string label = look(shade).label;
      if (there && !label.empty() && explained.insert(shade).second) place({.label = label, .shade = shade});
    }
  }

  void write_page_texts(int notes_px) {
    if (!figure_.title.empty()) {
      add("set label {} at screen {:.6f},{:.6f} left noenhanced font ',15'\n", gnuplot_text(figure_.title),
          across(kLeft), up(kTitle * 0.5));
    }
    double y = figure_.height_px - notes_px + kNoteRow * 0.5;
    for (const std::string& note : figure_.notes) {
      add("set label {} at screen {:.6f},{:.6f} left noenhanced font ',11' textcolor rgb '#555555'\n",
          gnuplot_text(note), across(kLeft), up(y));
      y += kNoteRow;
    }
  }

  void write_legend(const PreparedPanel& panel, double top) {
    for (const PreparedPanel::Entry& entry : panel.legend) {
      const double y = up(top + kLegendRow * (entry.row + 0.5));
      const double left = across(entry.x_px);
      const double right = across(entry.x_px + kLegendSample - 6);
      if (entry.line == nullptr) {
        const ShadeLook shown = look(entry.shade);
        const double half = 5.5 / figure_.height_px;
        add("set object rectangle from screen {:.6f},{:.6f} to screen {:.6f},{:.6f} fc rgb '{}' "
            "fillstyle transparent solid {:.2f} border lc rgb '#cccccc'\n",
            left, y - half, right, y + half, shown.colour, shown.opacity);
      } else {
        write_sample(*entry.line, left, right, y);
      }
      add("set label {} at screen {:.6f},{:.6f} left noenhanced\n", gnuplot_text(entry.label),
          across(entry.x_px + kLegendSample), y);
    }
  }

  void write_sample(const PreparedPanel::Line& line, double left, double right, double y) {
    const char* const colour = colour_of(*line.curve, line.order);
    const CurveStyle style = line.curve->style;
    if (style != CurveStyle::kPoints) {
      add("set arrow from screen {:.6f},{:.6f} to screen {:.6f},{:.6f} nohead lw 1.3 lc rgb '{}'{}\n", left,
          y, right, y, colour, style == CurveStyle::kDashed ? " dashtype (8,5)" : "");
    }
    if (style == CurveStyle::kPoints || style == CurveStyle::kLineAndPoints) {
      add("set label '' at screen {:.6f},{:.6f} point pt {} ps 0.5 lc rgb '{}'\n", (left + right) / 2.0, y,
          shape_of(line.order), colour);
    }
  }

  void write_axis(const char* axis, const Axis& settings, const AxisRange& range, double length_px) {
    add("set {}range [{}:{}] noextend\n", axis, range.from, range.to);
    if (!settings.log) {
      const double steps = std::max(length_px / kTickDistance, 2.0);
      add("unset logscale {0}\nset format {0} '%g'\nset {0}tics {1}\n", axis, tick_step(range, steps));
      return;
    }
    constexpr double kDecadesForPowers = 2.0;
    const bool powers = std::log10(range.to / range.from) >= kDecadesForPowers;
    add("set logscale {0}\nset {0}tics autofreq\nset format {0} '{1}'\n", axis, powers ? "10^{%L}" : "%g");
  }

  void write_panel(const PreparedPanel& panel, double top, double bottom) {
    constexpr double kNumbersAreWider = 2.5;  // Than they are high.
    add("set tmargin at screen {:.6f}\nset bmargin at screen {:.6f}\n", up(top), up(bottom));
    write_axis("x", *panel.x, panel.x_range, (right_px() - kLeft) / kNumbersAreWider);
    write_axis("y", panel.panel->y, panel.y_range, bottom - top);
    if (!panel.ticks_below) add("set format x ''\n");
    if (panel.ticks_below && !panel.x->label.empty()) {
      add("set label {} at screen {:.6f},{:.6f} center noenhanced\n", gnuplot_text(panel.x->label),
          across((kLeft + right_px()) / 2.0), up(bottom + kTicks + kAxisLabel * 0.5));
    }
    // Not as gnuplot's label of the axis, so that those of all panels stand in one line.
    constexpr double kMiddleOfLabel = 18.0;
    add("set label {} at screen {:.6f},{:.6f} center rotate by 90 noenhanced\n",
        gnuplot_text(panel.panel->y.label), across(kMiddleOfLabel), up((top + bottom) / 2.0));
    for (const Marker& marker : panel.panel->markers) {
      add("set label {} at first {},{} left offset character 0.6,0.4 noenhanced font ',11' front\n",
          gnuplot_text(marker.text), marker.x, marker.y);
    }
    write_data(panel);
  }

  void write_data(const PreparedPanel& panel) {
    std::vector<std::string> drawn;
    for (const Shade shade : kShades) {
      const std::string data = next_block();
      bool empty = true;
      for (const Band& band : panel.bands) {
        if (band.shade != shade) continue;
        add("{0:.9g} {2:.9g} {0:.9g} {1:.9g} {2:.9g} {3:.9g}\n", band.from, band.to, panel.y_range.from,
            panel.y_range.to);
        empty = false;
      }
      add("EOD\n");
      if (empty) continue;
      const ShadeLook shown = look(shade);
      drawn.push_back(fmt::format(
          "{} using 1:2:3:4:5:6 with boxxyerror fill transparent solid {:.2f} noborder fc rgb '{}'", data,
          shown.opacity, shown.colour));
    }
    for (const PreparedPanel::Line& line : panel.lines) {
      if (line.pieces.empty()) continue;
      const std::string data = next_block();
      for (const Polyline& piece : line.pieces) {
        for (std::size_t i = 0; i < piece.x.size(); ++i) add("{:.9g} {:.9g}\n", piece.x[i], piece.y[i]);
        add("\n");
      }
      add("EOD\n");
      drawn.push_back(fmt::format("{} with {} lc rgb '{}'", data, style_of(line.curve->style, line.order),
                                  colour_of(*line.curve, line.order)));
    }
    if (drawn.empty()) drawn.emplace_back("NaN");  // The axes at least.
    add("plot ");
    for (std::size_t i = 0; i < drawn.size(); ++i) add("{}{}", i > 0 ? ", \\\n  " : "", drawn[i]);
    add("\n");
  }

  static std::string style_of(CurveStyle style, std::size_t order) {
    switch (style) {
      case CurveStyle::kLine:
        return "lines lt 1 lw 1.3";
      case CurveStyle::kDashed:
        return "lines lt 1 lw 1.6 dashtype (8,5)";
      case CurveStyle::kPoints:
        return fmt::format("points pt {} ps 0.5", shape_of(order));
      case CurveStyle::kLineAndPoints:
        return fmt::format("linespoints lt 1 lw 1.3 pt {} ps 0.4", shape_of(order));
    }
    return "lines";
  }

  /// Opens a block of data that ends with EOD. \return its name.
  std::string next_block() {
    std::string name = fmt::format("$data{}", blocks_++);
    add("{} << EOD\n", name);
    return name;
  }

  const Figure& figure_;
  PictureFormat format_;
  std::vector<PreparedPanel> panels_;
  std::string text_;
  int blocks_ = 0;
};

}  // namespace

std::string gnuplot_script(const Figure& figure, PictureFormat format) {
  return Script{figure, format}.write();
}

}  // namespace stickslip::plot
