#include "report/record_figure.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "report/millimetres.hpp"
#include "report/record_trace.hpp"

namespace stickslip::report {
namespace {

/// Up to so many scans in view each scan is drawn as a dot.
constexpr std::size_t kMostScansWithDots = 250;

/// Most bands of modes in view: two pixels each at the usual width.
constexpr std::size_t kMostBands = 400;

/// The modes within the part; none if they change too often to be told apart.
std::vector<plot::Band> bands_of(const model::TestTruth& truth, const plot::AxisRange& part) {
  std::vector<plot::Band> bands;
  for (const model::ModeInterval& interval : truth.modes) {
    if (interval.end_s <= part.from || interval.start_s >= part.to) continue;
    const plot::Shade shade = interval.mode == model::Mode::kStick  ? plot::Shade::kStick
                              : interval.mode == model::Mode::kSlip ? plot::Shade::kSlip
                                                                    : plot::Shade::kSlack;
    bands.push_back({interval.start_s, interval.end_s, shade});
  }
  if (bands.size() > kMostBands) bands.clear();
  return bands;
}

/// Time at which the lines of a slip's S and K end: the next slip, else the end of its mode.
double end_of_cycle(const model::TestTruth& truth, std::size_t i) {
  if (i + 1 < truth.cycles.size()) return truth.cycles[i + 1].onset_time_s;
  for (const model::ModeInterval& mode : truth.modes) {
    if (mode.end_s > truth.cycles[i].onset_time_s) return mode.end_s;
  }
  return truth.cycles[i].onset_time_s;
}

void add_truth(plot::Panel& panel, const model::TestTruth& truth, const plot::AxisRange& part) {
  panel.bands = bands_of(truth, part);
  plot::Curve mu_s{
      .label = "S of each slip (truth)", .style = plot::CurveStyle::kDashed, .colour = plot::Colour::kGreen};
  plot::Curve mu_k{
      .label = "K of each slip (truth)", .style = plot::CurveStyle::kDashed, .colour = plot::Colour::kPurple};
  for (std::size_t i = 0; i < truth.cycles.size(); ++i) {
    const model::TrueCycle cycle = truth.cycles[i];
    for (const double time_s : {cycle.onset_time_s, end_of_cycle(truth, i)}) {
      mu_s.x.push_back(time_s);
      mu_s.y.push_back(cycle.mu_s);
      mu_k.x.push_back(time_s);
      mu_k.y.push_back(cycle.mu_k);
    }
  }
  if (truth.cycles.empty()) return;
  panel.curves.push_back(std::move(mu_s));
  panel.curves.push_back(std::move(mu_k));
}

void add_peaks(plot::Panel& panel, const base::LongColumn<detect::Cycle>& cycles) {
  plot::Curve sticks{.label = "peak found, sticks again",
                     .style = plot::CurveStyle::kPoints,
                     .colour = plot::Colour::kVermilion};
  plot::Curve slides{
      .label = "peak found, slides on", .style = plot::CurveStyle::kPoints, .colour = plot::Colour::kBlack};
  plot::Curve unseen{.label = "peak found, end not seen",
                     .style = plot::CurveStyle::kPoints,
                     .colour = plot::Colour::kOrange};
  for (const detect::Cycle& cycle : cycles) {
    plot::Curve& peaks = (cycle.flags & detect::kCycleCaptured) != 0 ? sticks
                         : std::isnan(cycle.capture_evidence)        ? unseen
                                                                     : slides;
    peaks.x.push_back(cycle.peak_time_s);
    peaks.y.push_back(cycle.peak);
  }
  if (!sticks.x.empty()) panel.curves.push_back(std::move(sticks));
  if (!slides.x.empty()) panel.curves.push_back(std::move(slides));
  if (!unseen.x.empty()) panel.curves.push_back(std::move(unseen));
}

plot::Panel force_panel(const record::Record& record, const RecordTrace& trace, const plot::AxisRange& part) {
  const double scans = (part.to - part.from) * record.header.board.scan_rate_granted_Hz;
  plot::Panel panel;
  panel.y.label = "force / weight";
  panel.height = 2.0;
  const auto style = scans <= static_cast<double>(kMostScansWithDots) ? plot::CurveStyle::kLineAndPoints
                                                                      : plot::CurveStyle::kLine;
  panel.curves.push_back({"force at each scan", trace.time_s, trace.value, style, plot::Colour::kBlue});
  if (record.end && record.end->truth) add_truth(panel, *record.end->truth, part);
  add_peaks(panel, record.cycles);
  return panel;
}

plot::Panel overview_panel(const RecordTrace& trace, const plot::AxisRange& whole,
                           const plot::AxisRange& part) {
  plot::Panel panel;
  panel.y.label = "whole record";
  panel.height = 0.7;
  panel.own_x = plot::Axis{.range = whole};
  panel.curves.push_back({"", trace.time_s, trace.value, plot::CurveStyle::kLine, plot::Colour::kBlue});
  panel.bands = {{part.from, part.to, plot::Shade::kWindow}};
  return panel;
}

plot::Panel derivative_panel(const record::Record& record, const RecordTrace& trace,
                             const plot::AxisRange& part) {
  const model::Tester tester = record.header.tester.tester();
  const std::optional<double> scaled = stretch_m(record);
  const double factor = scaled ? kMillimetresPerMetre * *scaled : 1.0;
  RecordTrace slope = derivative(trace, factor);
  plot::Panel panel;
  panel.y.label = scaled ? "stretching (mm/s)" : "rate of force / weight (1/s)";
  panel.height = 1.6;
  panel.curves.push_back({"difference of neighbouring scans", std::move(slope.time_s), std::move(slope.value),
                          plot::CurveStyle::kLine, plot::Colour::kBlue});
  if (scaled && tester.pull_speed_m_per_s) {
    const double speed = kMillimetresPerMetre * *tester.pull_speed_m_per_s;
    panel.curves.push_back({"speed of the pull, which sticking cannot exceed",
                            {part.from, part.to},
                            {speed, speed},
                            plot::CurveStyle::kDashed,
                            plot::Colour::kGreen});
  }
  if (record.end && record.end->truth) panel.bands = bands_of(*record.end->truth, part);
  return panel;
}

std::string facts_line(const record::Record& record) {
  std::string line =
      fmt::format("{} scans at {:.6g} Hz", record.scan.size(), record.header.board.scan_rate_granted_Hz);
  if (const auto speed = record.header.tester.pull_speed_m_per_s) {
    line += fmt::format("; pulled at {:.4g} mm/s", kMillimetresPerMetre * *speed);
  }
  if (record.end && record.end->truth) {
    const model::TestTruth& truth = *record.end->truth;
    line += fmt::format("; scene {}, seed {}; truth: {}", truth.scene_name, truth.seed,
                        model::name(truth.regime));
  }
  return line;
}

base::Result<plot::AxisRange> part_of(const RecordView& view, const plot::AxisRange& whole) {
  const plot::AxisRange part{view.from_s.value_or(whole.from), view.to_s.value_or(whole.to)};
  if (!(part.from >= 0.0) || !(part.from < whole.to)) {
    return base::usage_error("from {} s: must be from 0 s to below {:.6g} s, the end of the record",
                             part.from, whole.to);
  }
  if (!(part.to > part.from)) {
    return base::usage_error("to {} s: must be above {:.6g} s, where the picture begins", part.to, part.from);
  }
  return part;
}

}  // namespace

base::Result<plot::Figure> record_figure(const record::Record& record, const RecordView& view) {
  if (record.scan.size() < 2) return base::usage_error("the record has fewer than 2 scans");
  const base::Result<RecordTrace> trace = coefficient_trace(record);
  if (!trace) return tl::unexpected(trace.error());
  const plot::AxisRange whole{0.0, trace->time_s.back()};
  const base::Result<plot::AxisRange> part = part_of(view, whole);
  if (!part) return tl::unexpected(part.error());

  plot::Figure figure;
  figure.title = view.title.empty() ? record.header.title : view.title;
  figure.x = {.label = "time (s)", .range = *part};
  figure.notes = {facts_line(record)};
  if (view.overview) {
    figure.panels.push_back(overview_panel(*trace, whole, *part));
    figure.height_px += 130;
  }
  figure.panels.push_back(force_panel(record, *trace, *part));
  const bool has_modes = record.end && record.end->truth && !record.end->truth->modes.empty();
  if (has_modes && figure.panels.back().bands.empty()) {
    figure.notes.emplace_back("modes change too often to be shaded here: show a part of the record");
  }
  if (view.derivative) {
    figure.panels.push_back(derivative_panel(record, *trace, *part));
    figure.height_px += 200;
  }
  return figure;
}

}  // namespace stickslip::report
