#include "report/plot/figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "report/plot/gnuplot.hpp"
#include "report/plot/ranges.hpp"
#include "report/plot/script.hpp"
#include "report/plot/thinning.hpp"

namespace stickslip::plot {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Figure figure_with(std::vector<double> x, std::vector<double> y) {
  Figure figure;
  figure.title = "Title";
  figure.x.label = "time (s)";
  figure.panels.resize(1);
  figure.panels[0].y.label = "force (N)";
  figure.panels[0].curves = {{.label = "curve", .x = std::move(x), .y = std::move(y)}};
  return figure;
}

std::vector<Polyline> pieces(std::vector<double> x, std::vector<double> y, const AxisRange& range,
                             bool log = false) {
  return visible_pieces({.x = std::move(x), .y = std::move(y)}, range, log, log, 100);
}

TEST(Thinning, WhatIsNotFiniteBreaksTheLine) {
  const auto broken = pieces({0, 1, 2, 3, 4}, {5, 6, kNaN, 8, 9}, {0, 4});
  ASSERT_THAT(broken, SizeIs(2));
  EXPECT_THAT(broken[0].y, ElementsAre(5, 6));
  EXPECT_THAT(broken[1].y, ElementsAre(8, 9));
}

TEST(Thinning, OnALogAxisWhatIsNotPositiveBreaksTheLine) {
  EXPECT_THAT(pieces({1, 2, 3}, {1, 0, 1}, {1, 3}, true), SizeIs(2));
  EXPECT_THAT(pieces({-1, 0}, {1, 1}, {1, 3}, true), IsEmpty());
}

TEST(Thinning, ALineKeepsItsNeighboursOutsideTheRange) {
  const auto line = pieces({0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4, 5}, {2.5, 3.5});
  ASSERT_THAT(line, SizeIs(1));
  EXPECT_THAT(line[0].x, ElementsAre(2, 3, 4));
  // Also one that crosses the range without a point in it.
  EXPECT_THAT(pieces({0, 9}, {0, 9}, {4, 5}).at(0).x, ElementsAre(0, 9));
}

TEST(Thinning, EachColumnKeepsItsLowestAndHighestPointAndTheSizeIsBounded) {
  constexpr std::size_t kCount = 1'000'000;
  constexpr std::size_t kColumns = 100;
  std::vector<double> x(kCount);
  std::vector<double> y(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    x[i] = static_cast<double>(i) / kCount;
    y[i] = std::sin(static_cast<double>(i));
  }
  y[123'456] = 7.0;  // A single scan, in column 12.
  const auto thin = visible_pieces({.x = x, .y = y}, {0.0, 1.0}, false, false, kColumns);
  ASSERT_THAT(thin, SizeIs(1));
  EXPECT_LE(thin[0].x.size(), 2 * kColumns + 2);
  EXPECT_TRUE(std::is_sorted(thin[0].x.begin(), thin[0].x.end()));
  const auto extremes = [](const std::vector<double>& xs, const std::vector<double>& ys) {
    std::vector<std::pair<double, double>> of_column(kColumns, {10.0, -10.0});
    for (std::size_t i = 0; i < xs.size(); ++i) {
      auto& [low, high] = of_column.at(static_cast<std::size_t>(xs[i] * kColumns));
      low = std::min(low, ys[i]);
      high = std::max(high, ys[i]);
    }
    return of_column;
  };
  EXPECT_EQ(extremes(thin[0].x, thin[0].y), extremes(x, y));
}

TEST(Ranges, HaveRoomForConstantsEmptinessAndLogAxes) {
  Panel panel;
  const AxisRange x{0.0, 10.0};
  const auto y_range = [&](std::vector<double> y, bool log) {
    panel.y.log = log;
    panel.curves = {{.x = std::vector<double>(y.size(), 5.0), .y = std::move(y)}};
    return y_range_of(panel, x);
  };
  EXPECT_LT(y_range({3.0, 3.0}, false).from, 3.0);
  EXPECT_GT(y_range({0.0, 0.0}, false).to, 0.0);
  EXPECT_LT(y_range({kNaN}, false).from, y_range({kNaN}, false).to);
  EXPECT_GT(y_range({-1.0, 0.0, 1e-9, 1.0}, true).from, 0.0);
  EXPECT_LT(y_range({1e-9, 1.0}, true).from, 1e-9);
  // Only what is in view counts.
  panel.curves.push_back({.x = {11.0}, .y = {1e9}});
  EXPECT_LT(y_range_of(panel, x).to, 10.0);
}

TEST(Ranges, TicksAreRoundAndNotTooMany) {
  EXPECT_DOUBLE_EQ(tick_step({0.0, 1.0}, 5.0), 0.2);
  EXPECT_DOUBLE_EQ(tick_step({0.0, 1.0}, 4.0), 0.5);
  EXPECT_DOUBLE_EQ(tick_step({0.0, 7e6}, 1.0), 1e7);
  EXPECT_DOUBLE_EQ(tick_step({0.0, 1e-3}, 10.0), 1e-4);
}

TEST(Figure, IsAnSvgWithItsTextsAsTexts) {
  Figure figure = figure_with({0.0, 1.0, 2.0}, {1.0, 3.0, 2.0});
  figure.notes = {"a note"};
  figure.panels[0].markers = {{1.0, 3.0, "here"}};
  const base::Result<std::string> svg = draw_svg(figure);
  ASSERT_TRUE(svg) << svg.error().message;
  for (const char* text : {"Title", "time (s)", "force (N)", "curve", "a note", "here"}) {
    EXPECT_THAT(*svg, HasSubstr(std::string(">") + text + "<")) << text;
  }
  EXPECT_THAT(*svg, HasSubstr("rgb(  0, 114, 178)"));
}

TEST(Figure, TheSameFigureGivesTheSameText) {
  const Figure figure = figure_with({0.0, 1.0, 2.0}, {1.0, 3.0, 2.0});
  EXPECT_EQ(*draw_svg(figure), *draw_svg(figure));
}

// gnuplot replaces `…` by what a command prints, {…} and _ and ^ by layout, @name by macros.
TEST(Figure, TextsAreTakenLiterally) {
  const std::string odd = "it's `echo caught` $HOME {/Bold x}_y^2 @name %g 'x' \\n \"q\" µ ₀";
  Figure figure = figure_with({0.0, 1.0}, {1.0, 2.0});
  figure.title = figure.x.label = figure.panels[0].y.label = figure.panels[0].curves[0].label = odd;
  figure.notes = {odd};
  figure.panels[0].markers = {{0.5, 1.5, odd}};
  const base::Result<std::string> svg = draw_svg(figure);
  ASSERT_TRUE(svg) << svg.error().message;
  EXPECT_THAT(*svg, Not(HasSubstr(">caught")));
  const std::string expected = "it's `echo caught` $HOME {/Bold x}_y^2 @name %g 'x' \\n \"q\" µ ₀";
  std::size_t count = 0;
  for (std::size_t at = svg->find(expected); at != std::string::npos; at = svg->find(expected, at + 1))
    ++count;
  EXPECT_EQ(count, 6U);
}

TEST(Figure, NewLinesCannotBecomeCommands) {
  Figure figure = figure_with({0.0, 1.0}, {1.0, 2.0});
  figure.title = "a\nset output '/nonexistent/x'\nEOD\n!touch x";
  const std::string script = gnuplot_script(figure, PictureFormat::kSvg);
  EXPECT_THAT(script, Not(HasSubstr("\nset output")));
  EXPECT_THAT(script, Not(HasSubstr("\n!touch")));
  EXPECT_TRUE(draw_svg(figure));
}

TEST(Figure, LogAxesHavePowersOfTen) {
  Figure figure = figure_with({1e-9, 1e-7, 1e-5}, {1e-2, 1e-8, 0.0});
  figure.x.log = true;
  figure.panels[0].y.log = true;
  figure.panels[0].curves[0].style = CurveStyle::kLineAndPoints;
  const base::Result<std::string> svg = draw_svg(figure);
  ASSERT_TRUE(svg) << svg.error().message;
  EXPECT_THAT(*svg, AllOf(HasSubstr(">10"), HasSubstr(">−8<")));
}

TEST(Figure, NothingToShowIsAnEmptyFrame) {
  for (const bool log : {false, true}) {
    Figure figure = figure_with({kNaN}, {kNaN});
    figure.x.log = figure.panels[0].y.log = log;
    const base::Result<std::string> svg = draw_svg(figure);
    EXPECT_TRUE(svg) << svg.error().message;
  }
}

TEST(Figure, PanelsBandsAndTheirLegendStandOneUnderTheOther) {
  Figure figure = figure_with({0.0, 1.0, 2.0}, {1.0, 3.0, 2.0});
  figure.panels[0].bands = {{0.0, 0.5, Shade::kStick}, {0.5, 0.75, Shade::kSlip}, {5.0, 6.0, Shade::kSlack}};
  figure.panels.push_back(figure.panels[0]);
  const base::Result<std::string> svg = draw_svg(figure);
  ASSERT_TRUE(svg) << svg.error().message;
  // Explained once; what is not in view is not explained.
  EXPECT_EQ(svg->find(">stick<"), svg->rfind(">stick<"));
  EXPECT_THAT(*svg, AllOf(HasSubstr(">stick<"), HasSubstr(">slip<"), Not(HasSubstr(">slack<"))));
}

TEST(Gnuplot, ItsOwnWordsAreInTheError) {
  const base::Result<std::string> nonsense = run_gnuplot("plot nonsense\n");
  ASSERT_FALSE(nonsense);
  EXPECT_EQ(nonsense.error().kind, base::ErrorKind::kFailure);
  EXPECT_THAT(nonsense.error().message, AllOf(HasSubstr("nonsense"), Not(HasSubstr("\n"))));
}

TEST(Gnuplot, MoreThanAPipeHoldsGoesInAndOut) {
  // 64 KiB fit into a pipe.
  std::string text(1'000'000, 'x');
  const base::Result<std::string> printed = run_gnuplot("set print '-'\ntext = '" + text + "'\nprint text\n");
  ASSERT_TRUE(printed) << printed.error().message;
  EXPECT_EQ(*printed, text + "\n");
}

}  // namespace
}  // namespace stickslip::plot
