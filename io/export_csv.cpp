#include "io/export_csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "io/fact_line.hpp"

#include "core/analysis/results.hpp"
#include "core/base/text.hpp"
#include "core/daq/calibration.hpp"
#include "core/daq/second_channel.hpp"
#include "core/record/enum_names.hpp"
#include "core/record/fields.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/json_codec.hpp"

namespace stickslip::io {
namespace {

using record::FieldName;

constexpr std::string_view unit(daq::SecondQuantity quantity) noexcept {
  return quantity == daq::SecondQuantity::kPullSpeed ? "m/s" : "m";
}

/// Writes a fact as one comment line; line feeds in it are escaped.
void add_fact(std::string& text, std::string_view name, std::string_view value, std::string_view unit = "") {
  if (value.empty()) return;
  text += fmt::format("# {}: {}", name, base::csv_comment(value));
  text += unit.empty() || unit == "1" ? "\n" : fmt::format(" {}\n", unit);
}

/// Visitor for record::for_each_field(): single facts.
class FactLines {
 public:
  explicit FactLines(std::string& text) : text_(text) {}

  void operator()(const FieldName& name, const std::string& value) const {
    add_fact(text_, name.name, value);
  }
  template <typename T>
  void operator()(const FieldName& name, const std::optional<T>& value) const {
    if (value) add_fact(text_, name.name, fmt::format("{}", *value), name.unit);
  }
  void operator()(const FieldName& name, double value) const {
    add_fact(text_, name.name, fmt::format("{}", value), name.unit);
  }
  template <typename T>
  void operator()(const FieldName&, const std::vector<T>&) const {}  // The record itself has the tables.

 private:
  std::string& text_;
};

std::string facts_text(const record::Record& record) {
  const record::RecordHeader& header = record.header;
  std::string text;
  add_fact(text, "record", header.title);
  add_fact(text, "uuid", header.uuid);
  if (header.start_realtime_ns) add_fact(text, "start_time", record::iso_time(*header.start_realtime_ns));
  add_fact(text, "program",
           fmt::format("{} {} ({})", header.process.program, header.process.version, header.process.commit));
  const FactLines line{text};
  record::for_each_name_field(header.board, line);
  line(FieldName{"scan_rate_granted", "Hz", ""}, header.board.scan_rate_granted_Hz);
  if (header.load_cell) record::for_each_field(*header.load_cell, line);
  if (header.load_cell) add_fact(text, "calibrated", header.calibration.date);
  if (header.board.second) {
    const daq::SecondChannel& second = *header.board.second;
    add_fact(text, fmt::format("{}_gain", daq::name(second.quantity)), fmt::format("{}", second.gain_per_V),
             fmt::format("{}/V", unit(second.quantity)));
    add_fact(text, fmt::format("{}_zero", daq::name(second.quantity)), fmt::format("{}", second.zero_V), "V");
  }
  record::for_each_field(header.tester, line);
  for (const auto& [name, value] : {std::pair{"sample", &header.sample.name},
                                    {"grade", &header.sample.grade},
                                    {"direction", &header.sample.direction},
                                    {"side", &header.sample.side},
                                    {"operator", &header.sample.operator_name}}) {
    add_fact(text, name, *value);
  }
  line(FieldName{"replicate", "1", ""}, header.sample.replicate);
  for (const auto& [key, value] : header.sample.metadata) add_fact(text, "metadata." + key, value);
  add_fact(text, "method", header.process.method);
  add_fact(text, "estimator", header.process.estimator);
  if (!record.end) return text;
  add_fact(text, "status", record::name(record.end->status));
  const analysis::TestResults& results = record.end->results;
  add_fact(text, "regime", model::name(results.regime));
  add_fact(text, "rung", analysis::name(results.rung));
  analysis::for_each_result(
      results, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
        if (!estimate.value || name.is_diagnostic) return;
        add_fact(text, name.name,
                 estimate.standard_error ? fmt::format("{} +- {}", *estimate.value, *estimate.standard_error)
                                         : fmt::format("{}", *estimate.value),
                 name.unit);
      });
  return text;
}

/// Suffix of a name for a unit: "_s", "_m_per_s", empty for a ratio.
std::string unit_suffix(std::string_view unit) {
  if (unit == "1") return {};
  std::string suffix{"_"};
  for (const char c : unit) suffix += c == '/' ? std::string{"_per_"} : std::string{c};
  return suffix;
}

template <typename T>
std::string field_text(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? fmt::format("{}", value) : std::string{};
  } else {
    return fmt::format("{}", value);
  }
}

/// ",pull_speed_counts,pull_speed_m_per_s"
std::string second_columns(const daq::SecondChannel& channel) {
  const std::string_view name = daq::name(channel.quantity);
  return fmt::format(",{0}_counts,{0}{1}", name, unit_suffix(unit(channel.quantity)));
}

/// The fields of the second channel. Both are empty if the code did not arrive.
void add_second(std::string& text, const daq::SecondChannel& channel, std::int32_t code) {
  text += code == daq::SecondChannel::kNoCode ? "," : fmt::format(",{}", code);
  text += "," + field_text(channel.value(code));
}

/// The whole header in one line. The idle scans of the self-check are too many for a line.
std::string header_line(record::RecordHeader header) {
  if (header.self_check) header.self_check->raw.clear();
  return fact_line(kHeaderFact, record::header_to_json(header));
}

/// The facts that are no scans. A record without an end is that of an interrupted test.
std::string lines_below(const record::Record& record) {
  std::string text;
  for (const daq::Gap& gap : record.gaps) text += fact_line(kGapFact, record::gap_to_json(gap));
  for (const record::Event& event : record.events)
    text += fact_line(kEventFact, record::event_to_json(event));
  for (const record::ClockAnchor& anchor : record.anchors)
    text +=
        fmt::format("# {}: {} {} {}\n", kAnchorFact, anchor.scan, anchor.monotonic_ns, anchor.realtime_ns);
  record::EndRecord end;
  if (record.end) {
    end.status = record.end->status;
    end.reasons = record.end->reasons;
    end.cause = record.end->cause;
    end.end_realtime_ns = record.end->end_realtime_ns;
    end.read_latency = record.end->read_latency;
    end.unloaded_level = record.end->unloaded_level;
  } else {
    end.status = record::Status::kInterrupted;
    end.reasons.emplace_back(record::kInterruptedWhy);
    end.cause = record::kProgramDied;
  }
  std::vector<std::byte> bytes;
  record::append_end_bytes(end, bytes);
  text += fmt::format("# {}: {}\n", kScansFact, record.scan.size());
  // No table follows the JSON: there are no cycles and no truth.
  return text + fact_line(kEndFact, {reinterpret_cast<const char*>(bytes.data()), bytes.size() - 1});
}

}  // namespace

std::string scans_csv(const record::Record& record) {
  const daq::BoardInfo& board = record.header.board;
  const daq::RawQuantity quantity = board.quantity;
  const bool counts = quantity == daq::RawQuantity::kCounts;
  // What is not known is not invented: a coefficient needs the sled's weight, a force the cell or that
  // weight.
  const bool weight_known = record.header.tester.sled_mass_kg.has_value();
  const bool volts = (counts || quantity == daq::RawQuantity::kVolts);
  const bool force =
      volts ? record.header.load_cell.has_value() : quantity == daq::RawQuantity::kForce_N || weight_known;
  const bool coefficient = quantity == daq::RawQuantity::kCoefficient || (force && weight_known);
  const daq::Calibration calibration{board, record.header.load_cell.value_or(daq::LoadCell{}),
                                     record.header.tester.tester().normal_load_N()};
  std::string text = facts_text(record) + header_line(record.header);
  text += "time_s,scan";
  if (counts) text += ",counts";
  if (volts) text += ",voltage_V";
  if (force) text += ",force_N";
  if (coefficient) text += ",coefficient";
  if (!record.second.empty()) text += second_columns(*board.second);
  text += ",spike,saturated\n";
  auto spike = record.spikes.begin();
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < record.scan.size(); ++i) {
    const double raw = record.raw[i];
    const auto since_first = static_cast<double>(record.scan[i] - record.scan.front());
    fmt::format_to(out, "{},{}", since_first / board.scan_rate_granted_Hz, record.scan[i]);
    if (counts) fmt::format_to(out, ",{}", raw);
    if (volts) fmt::format_to(out, ",{}", calibration.volts(raw));
    if (force) fmt::format_to(out, ",{}", calibration.force_N(raw));
    if (coefficient) fmt::format_to(out, ",{}", calibration.coefficient(raw));
    if (!record.second.empty()) add_second(text, *board.second, record.second[i]);
    while (spike != record.spikes.end() && *spike < record.scan[i]) ++spike;
    const bool is_spike = spike != record.spikes.end() && *spike == record.scan[i];
    fmt::format_to(out, ",{:d},{:d}\n", is_spike, calibration.saturated(raw));
  }
  return text + lines_below(record);
}

std::string cycles_csv(const record::Record& record) {
  std::string text = facts_text(record);
  std::string header;
  record::for_each_cycle_column([&](const FieldName& name, auto) {
    header += fmt::format("{}{}{}", header.empty() ? "" : ",", name.name, unit_suffix(name.unit));
  });
  text += header + "\n";
  for (const detect::Cycle& cycle : record.cycles) {
    std::string row;
    record::for_each_cycle_column([&](const FieldName&, auto member) {
      if (!row.empty()) row += ',';
      row += field_text(cycle.*member);
    });
    text += row + "\n";
  }
  return text;
}

}  // namespace stickslip::io
