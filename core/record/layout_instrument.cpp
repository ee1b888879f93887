#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/record/enum_names.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/range_check.hpp"

namespace stickslip::record {
namespace {

constexpr FieldName kLatencyLimit{"below", "s", "upper limit of the bin, of the last one infinite [s]"};
constexpr FieldName kLatencyCount{"read_count", "1", "reads that were so late [1]"};
constexpr FieldName kLatencyLargest{"largest", "s", "lateness of the latest read [s]"};

void write_latency(hid_t timing, const daq::LatencyHistogram& latency) {
  TableWriter table{make_group(timing, "read_latency", "NXcollection")};
  std::vector<double> limits_s;
  for (std::size_t bin = 0; bin < daq::LatencyHistogram::kBins; ++bin) {
    limits_s.push_back(daq::LatencyHistogram::limit_s(bin));
  }
  table.add(kLatencyLimit, limits_s);
  table.add(kLatencyCount, std::vector<std::uint64_t>(latency.counts().begin(), latency.counts().end()));
  write_scalar(table.group(), kLatencyLargest, latency.largest_s());
}

std::optional<daq::LatencyHistogram> read_latency(hid_t timing) {
  // Records made before it was kept have none.
  if (!has(timing, "read_latency")) return std::nullopt;
  const GroupHandle group = open_group(timing, "read_latency");
  const auto counts =
      read_column<std::uint64_t>(group.get(), std::string{kLatencyCount.name}, daq::LatencyHistogram::kBins);
  daq::LatencyHistogram::Counts bins{};
  std::copy(counts.begin(), counts.end(), bins.begin());
  return daq::LatencyHistogram{bins, read_scalar<double>(group.get(), std::string{kLatencyLargest.name})};
}

void write_timing(hid_t entry, const Record& record) {
  TableWriter table{make_group(entry, "timing", "NXcollection")};
  for_each_rate_field(record.header.board, FieldWriter{table.group()});
  std::vector<std::int64_t> scan;
  std::vector<std::int64_t> monotonic;
  std::vector<std::int64_t> realtime;
  for (const ClockAnchor& anchor : record.anchors) {
    scan.push_back(anchor.scan);
    monotonic.push_back(anchor.monotonic_ns);
    realtime.push_back(anchor.realtime_ns);
  }
  table.add(FieldName{"scan", "1", "scan at which the clocks were read [1]"}, scan);
  table.add(FieldName{"monotonic_raw", "ns", "CLOCK_MONOTONIC_RAW [ns]"}, monotonic);
  table.add(FieldName{"realtime", "ns", "time since 1970-01-01T00:00:00Z [ns]"}, realtime);
  if (record.end->read_latency) write_latency(table.group(), *record.end->read_latency);
}

void read_timing(hid_t entry, Record& record) {
  const GroupHandle group = open_group(entry, "timing");
  for_each_rate_field(record.header.board, FieldReader{group.get()});
  const auto scan = read_column<std::int64_t>(group.get(), "scan");
  const auto monotonic = read_column<std::int64_t>(group.get(), "monotonic_raw", scan.size());
  const auto realtime = read_column<std::int64_t>(group.get(), "realtime", scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) {
    record.anchors.push_back(range_checked(ClockAnchor{scan[i], monotonic[i], realtime[i]}));
  }
  record.end->read_latency = read_latency(group.get());
}

void write_plan(hid_t entry, const PlanFacts& plan) {
  if (plan == PlanFacts{}) return;
  for_each_field(plan, FieldWriter{make_group(entry, "plan", "NXcollection").get()});
}

/// The scans in the type and under the name of those of the test.
template <typename Stored>
void write_idle_scans(hid_t group, const FieldName& name, const std::vector<double>& raw) {
  const std::vector<Stored> stored(raw.begin(), raw.end());
  write_column(group, name, std::span<const Stored>{stored});
}

void write_self_check(hid_t entry, const RecordHeader& header) {
  if (!header.self_check) return;
  const GroupHandle group = make_group(entry, "self_check", "NXcollection");
  const daq::SelfCheck& check = *header.self_check;
  for_each_field(check, FieldWriter{group.get()});
  if (check.raw.empty()) return;
  const QuantityName quantity = name(header.board.quantity);
  const std::string long_name = fmt::format("{} with no load [{}]", quantity.name, quantity.unit);
  const FieldName field{quantity.name, quantity.unit, long_name};
  if (header.board.quantity != daq::RawQuantity::kCounts) {
    write_idle_scans<double>(group.get(), field, check.raw);
  } else if (counts_fit_u16(header.board)) {
    write_idle_scans<std::uint16_t>(group.get(), field, check.raw);
  } else {
    write_idle_scans<std::uint32_t>(group.get(), field, check.raw);
  }
}

template <typename Stored>
std::vector<double> read_idle_scans(hid_t group, const std::string& name) {
  const auto stored = read_column<Stored>(group, name);
  return {stored.begin(), stored.end()};
}

void read_self_check(hid_t entry, RecordHeader& header) {
  if (!has(entry, "self_check")) return;
  const GroupHandle group = open_group(entry, "self_check");
  daq::SelfCheck& check = header.self_check.emplace();
  for_each_field(check, FieldReader{group.get()});
  const std::string quantity{name(header.board.quantity).name};
  if (!has(group.get(), quantity)) return;
  if (header.board.quantity != daq::RawQuantity::kCounts) {
    check.raw = read_idle_scans<double>(group.get(), quantity);
  } else if (counts_fit_u16(header.board)) {
    check.raw = read_idle_scans<std::uint16_t>(group.get(), quantity);
  } else {
    check.raw = read_idle_scans<std::uint32_t>(group.get(), quantity);
  }
}

}  // namespace

void write_instrument(hid_t entry, const Record& record) {
  const RecordHeader& header = record.header;
  const GroupHandle instrument = make_group(entry, "instrument", "NXinstrument");
  for_each_field(header.tester, FieldWriter{make_group(instrument.get(), "tester", "NXcollection").get()});
  const GroupHandle adc = make_group(instrument.get(), "adc", "NXdetector");
  for_each_name_field(header.board, FieldWriter{adc.get()});
  if (header.board.quantity == daq::RawQuantity::kCounts) {
    for_each_converter_field(header.board, FieldWriter{adc.get()});
  }
  const GroupHandle calibration = make_group(instrument.get(), "calibration", "NXcalibration");
  for_each_field(header.calibration, FieldWriter{calibration.get()});
  if (header.load_cell) for_each_field(*header.load_cell, FieldWriter{calibration.get()});

  write_timing(entry, record);
  const GroupHandle sample = make_group(entry, "sample", "NXsample");
  for_each_field(header.sample, FieldWriter{sample.get()});
  // Numbers for readers; the reader of records takes the texts of entry/metadata.
  for (const KnownFact& fact : known_facts()) {
    const auto stated = header.sample.metadata.find(fact.key);
    if (stated == header.sample.metadata.end()) continue;
    const std::string long_name = fmt::format("{} [{}]", fact.long_name, fact.unit);
    if (const auto number = fact_number(fact.key, stated->second))
      write_scalar(sample.get(), FieldName{fact.key, fact.unit, long_name}, *number);
  }
  const GroupHandle user = make_group(entry, "user", "NXuser");
  FieldWriter{user.get()}(FieldName{"name", "", ""}, header.sample.operator_name);
  write_plan(entry, header.plan);
  write_self_check(entry, header);
}

void read_instrument(hid_t entry, Record& record) {
  RecordHeader& header = record.header;
  const GroupHandle instrument = open_group(entry, "instrument");
  for_each_field(header.tester, FieldReader{open_group(instrument.get(), "tester").get()});
  const GroupHandle adc = open_group(instrument.get(), "adc");
  for_each_name_field(header.board, FieldReader{adc.get()});
  if (header.board.quantity == daq::RawQuantity::kCounts) {
    for_each_converter_field(header.board, FieldReader{adc.get()});
  }
  const GroupHandle calibration = open_group(instrument.get(), "calibration");
  for_each_field(header.calibration, FieldReader{calibration.get()});
  if (has(calibration.get(), "gain")) {
    for_each_field(header.load_cell.emplace(), FieldReader{calibration.get()});
  }
  read_timing(entry, record);
  for_each_field(header.sample, FieldReader{open_group(entry, "sample").get()});
  const GroupHandle user = open_group(entry, "user");
  FieldReader{user.get()}(FieldName{"name", "", ""}, header.sample.operator_name);
  if (has(entry, "plan")) for_each_field(header.plan, FieldReader{open_group(entry, "plan").get()});
  read_self_check(entry, header);
}

}  // namespace stickslip::record
