#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "core/record/enum_names.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/long_tables.hpp"
#include "core/record/range_check.hpp"

namespace stickslip::record {
namespace {

const std::vector<std::string> kCycleFlagMeaning{"has_spike", "has_gap", "saturated", "captured", "first"};

/// One member of each element.
template <typename Row, typename Value>
std::vector<Value> column_of(const std::vector<Row>& rows, Value Row::*member) {
  std::vector<Value> column;
  column.reserve(rows.size());
  for (const Row& row : rows) column.push_back(row.*member);
  return column;
}

void write_cycles(hid_t entry, const base::LongColumn<detect::Cycle>& cycles) {
  TableWriter table{make_group(entry, "cycles", "NXdata")};
  write_attribute(table.group(), "signal", "delta_mu");
  write_attribute(table.group(), "axes", std::vector<std::string>{"cycle"});
  for_each_cycle_column([&](const FieldName& name, auto member) {
    const DatasetHandle column = write_member(table, name, cycles, member);
    if (name.name == "flags") write_attribute(column.get(), "meaning", kCycleFlagMeaning);
  });
}

/// Columns that the first records do not have.
bool came_later(std::string_view column) {
  constexpr std::array kLater{std::string_view{"pull_speed"}, std::string_view{"capture_evidence"},
                              std::string_view{"live_capture_evidence"},
                              std::string_view{"live_decision_time"}};
  return std::ranges::find(kLater, column) != kLater.end();
}

template <typename Use>
void for_each_cycle(hid_t entry, const Use& use) {
  if (!has(entry, "cycles")) return;
  const GroupHandle group = open_group(entry, "cycles");
  for_each_row<detect::Cycle>(
      group.get(), "cycle",
      [&](std::size_t first, std::vector<detect::Cycle>& rows, std::size_t count) {
        for_each_cycle_column([&](const FieldName& name, auto member) {
          if (came_later(name.name) && !has(group.get(), std::string{name.name})) return;
          read_member(group.get(), name, member, count, first, rows);
        });
      },
      use);
}

void write_gaps(hid_t entry, const std::vector<daq::Gap>& gaps) {
  TableWriter table{make_group(entry, "gaps", "NXcollection")};
  std::vector<std::uint8_t> estimated;
  std::vector<std::string> causes;
  for (const auto& gap : gaps) {
    estimated.push_back(gap.estimated ? 1 : 0);
    causes.emplace_back(daq::name(gap.cause));
  }
  table.add(FieldName{"first_scan", "1", "first scan that is missing [1]"},
            column_of(gaps, &daq::Gap::first));
  table.add(FieldName{"scan_count", "1", "number of scans missing [1]"}, column_of(gaps, &daq::Gap::count));
  table.add(FieldName{"estimated", "1", "1 if the number comes from a clock [1]"}, estimated);
  table.add("cause", causes);
}

std::vector<daq::Gap> read_gaps(hid_t entry) {
  if (!has(entry, "gaps")) return {};
  const GroupHandle group = open_group(entry, "gaps");
  const auto first = read_column<std::int64_t>(group.get(), "first_scan");
  const auto count = read_column<std::int64_t>(group.get(), "scan_count", first.size());
  const auto estimated = read_column<std::uint8_t>(group.get(), "estimated", first.size());
  const auto causes = read_texts(group.get(), "cause");
  if (causes.size() != first.size()) throw HdfError("gaps/cause has another length than gaps/first_scan");
  std::vector<daq::Gap> gaps;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto cause = gap_cause_from_name(causes[i]);
    if (!cause) throw HdfError(fmt::format("gaps/cause '{}' is unknown", causes[i]));
    gaps.push_back(range_checked(daq::Gap{first[i], count[i], estimated[i] != 0, *cause}));
  }
  return gaps;
}

void write_events(hid_t entry, const std::vector<Event>& events) {
  TableWriter table{make_group(entry, "events", "NXcollection")};
  table.add(FieldName{"scan", "1", "scan at the event [1]"}, column_of(events, &Event::scan));
  table.add(FieldName{"realtime", "ns", "time since 1970-01-01T00:00:00Z [ns]"},
            column_of(events, &Event::realtime_ns));
  table.add("text", column_of(events, &Event::text));
}

std::vector<Event> read_events(hid_t entry) {
  if (!has(entry, "events")) return {};
  const GroupHandle group = open_group(entry, "events");
  const auto scan = read_column<std::int64_t>(group.get(), "scan");
  const auto realtime = read_column<std::int64_t>(group.get(), "realtime", scan.size());
  const auto texts = read_texts(group.get(), "text");
  if (texts.size() != scan.size()) throw HdfError("events/text has another length than events/scan");
  std::vector<Event> events;
  for (std::size_t i = 0; i < scan.size(); ++i)
    events.push_back({range_checked(scan[i]), realtime[i], texts[i]});
  return events;
}

}  // namespace

void write_tables(hid_t entry, const Record& record) {
  write_cycles(entry, record.cycles);
  write_gaps(entry, record.gaps);
  write_events(entry, record.events);
}

void read_cycles(hid_t entry, Record& record) {
  record.cycles.clear();
  for_each_cycle(entry, [&](const detect::Cycle& cycle) { record.cycles.push_back(cycle); });
}

void read_tables(hid_t entry, Record& record) {
  read_cycles(entry, record);
  record.gaps = read_gaps(entry);
  record.events = read_events(entry);
}

void check_tables(hid_t entry) {
  for_each_cycle(entry, [](const detect::Cycle&) {});
  static_cast<void>(read_gaps(entry));
  static_cast<void>(read_events(entry));
}

}  // namespace stickslip::record
