#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kGroup = "second";

std::string counts_name(daq::SecondQuantity quantity) {
  return fmt::format("{}_counts", daq::name(quantity));
}

FieldName value_name(daq::SecondQuantity quantity) {
  return quantity == daq::SecondQuantity::kPullSpeed
             ? FieldName{"pull_speed", "m/s", "pull speed, measured [m/s]"}
             : FieldName{"sled_position", "m", "position of the sled, measured [m]"};
}

}  // namespace

void write_second(hid_t entry, const Record& record, const ScanSource& scans) {
  if (!record.header.board.second) return;
  const daq::SecondChannel& channel = *record.header.board.second;
  const GroupHandle instrument = open_group(entry, "instrument");
  const GroupHandle facts = make_group(instrument.get(), kGroup, "NXdetector");
  write_text(facts.get(), "quantity", daq::name(channel.quantity));
  for_each_field(channel, FieldWriter{facts.get()});

  if (!scans.has_second()) return;
  const GroupHandle raw = open_group(entry, "raw");
  const DatasetHandle time = open_dataset(raw.get(), "time");
  const FieldName value = value_name(channel.quantity);
  const std::string counts = counts_name(channel.quantity);
  ColumnWriter<float> values{raw.get(), value, scans.size()};
  attach_scale(values.dataset(), time, std::string{value.name});
  ColumnWriter<std::int32_t> codes{raw.get(), FieldName{counts, "1", "A/D code of the second channel [1]"},
                                   scans.size()};
  attach_scale(codes.dataset(), time, counts);
  scans.for_each_second_piece([&](std::span<const std::int32_t> piece) {
    std::vector<float> converted;
    converted.reserve(piece.size());
    for (const std::int32_t code : piece) converted.push_back(static_cast<float>(channel.value(code)));
    values.append(converted);
    codes.append(piece);
  });
}

void read_second_channel(hid_t entry, Record& record) {
  const GroupHandle instrument = open_group(entry, "instrument");
  if (!has(instrument.get(), kGroup)) return;
  const GroupHandle facts = open_group(instrument.get(), kGroup);
  const std::string quantity = read_text(facts.get(), "quantity");
  const auto known = daq::second_quantity_from_name(quantity);
  if (!known) throw HdfError(fmt::format("instrument/second/quantity '{}' is unknown", quantity));
  daq::SecondChannel& channel = record.header.board.second.emplace();
  channel.quantity = *known;
  for_each_field(channel, FieldReader{facts.get()});
}

void read_second(hid_t entry, Record& record) {
  if (!record.header.board.second) return;
  const daq::SecondChannel& channel = *record.header.board.second;
  const GroupHandle raw = open_group(entry, "raw");
  const std::string counts = counts_name(channel.quantity);
  if (!has(raw.get(), counts)) return;
  record.second = read_column<std::int32_t>(raw.get(), counts, record.scan.size());
  const auto possible = [&](std::int32_t code) {
    return code >= daq::SecondChannel::kNoCode && code <= static_cast<std::int64_t>(channel.maxdata);
  };
  if (!std::all_of(record.second.begin(), record.second.end(), possible)) {
    throw HdfError(fmt::format("raw/{} exceeds instrument/second/maxdata", counts));
  }
}

void verify_second(hid_t entry, const Record& record, const ScanSource& scans) {
  if (!record.header.board.second || !scans.has_second()) return;
  const GroupHandle raw = open_group(entry, "raw");
  const std::string counts = counts_name(record.header.board.second->quantity);
  if (row_count(raw.get(), counts) != scans.size()) throw HdfError("holds another second channel");
  const DatasetHandle column = open_dataset(raw.get(), counts);
  std::size_t row = 0;
  scans.for_each_second_piece([&](std::span<const std::int32_t> piece) {
    std::vector<std::int32_t> back(piece.size());
    read_rows<std::int32_t>(column, counts, row, back);
    if (!std::equal(back.begin(), back.end(), piece.begin())) throw HdfError("holds another second channel");
    row += piece.size();
  });
}

}  // namespace stickslip::record
