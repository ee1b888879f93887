#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/daq/calibration.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/words.hpp"

namespace stickslip::record {
namespace {

/// Bits of raw/flags.
enum ScanFlag : std::uint8_t {
  kSpike = 1U << 0U,
  kSaturated = 1U << 1U,
  kReplacedForDetection = 1U << 2U,
};
const std::vector<std::string> kFlagMeaning{"spike", "saturated", "replaced_for_detection"};

std::vector<double> times_s(const Record& record) {
  std::vector<double> times;
  times.reserve(record.scan.size());
  for (const daq::ScanIndex scan : record.scan) {
    times.push_back(static_cast<double>(scan - record.scan.front()) /
                    record.header.board.scan_rate_granted_Hz);
  }
  return times;
}

std::vector<std::uint8_t> flags_of(const Record& record) {
  std::vector<std::uint8_t> flags(record.scan.size(), 0);
  for (const daq::ScanIndex spike : record.spikes) {
    const auto at = std::lower_bound(record.scan.begin(), record.scan.end(), spike);
    if (at == record.scan.end() || *at != spike) continue;
    flags[static_cast<std::size_t>(at - record.scan.begin())] = kSpike | kReplacedForDetection;
  }
  if (record.header.board.quantity == daq::RawQuantity::kCounts) {
    const auto maxdata = static_cast<double>(record.header.board.maxdata);
    for (std::size_t i = 0; i < flags.size(); ++i) {
      if (record.raw[i] <= 0.0 || record.raw[i] >= maxdata) flags[i] |= kSaturated;
    }
  }
  return flags;
}

template <typename Count>
void add_counts(TableWriter& table, const Record& record) {
  const std::vector<Count> counts(record.raw.begin(), record.raw.end());
  const DatasetHandle column = table.add(FieldName{"counts", "1", "A/D code [1]"}, counts);
  write_number_attribute(column.get(), "maxdata", record.header.board.maxdata);
}

std::vector<float> forces_N(const Record& record) {
  constexpr double kAnyLoad_N = 1.0;  // Force does not depend on it.
  const daq::Calibration calibration{record.header.board, *record.header.load_cell, kAnyLoad_N};
  std::vector<float> forces;
  forces.reserve(record.raw.size());
  for (const double raw : record.raw) forces.push_back(static_cast<float>(calibration.force_N(raw)));
  return forces;
}

template <typename Stored>
void read_values(hid_t raw, const std::string& name, Record& record) {
  const auto values = read_column<Stored>(raw, name, record.scan.size());
  record.raw.assign(values.begin(), values.end());
}

}  // namespace

void write_raw(hid_t entry, const Record& record) {
  const daq::BoardInfo& board = record.header.board;
  const bool counts = board.quantity == daq::RawQuantity::kCounts;
  const QuantityName quantity = name(board.quantity);

  TableWriter table{make_group(entry, "raw", "NXdata")};
  write_attribute(table.group(), "signal", counts ? "force" : quantity.name);
  write_attribute(table.group(), "axes", std::vector<std::string>{"time"});
  table.add(FieldName{"time", "s", "time after the first scan [s]"}, times_s(record));
  table.add(FieldName{"scan", "1", "scan index of the acquisition [1]"}, record.scan);
  if (counts) {
    if (counts_fit_u16(board)) {
      add_counts<std::uint16_t>(table, record);
    } else {
      add_counts<std::uint32_t>(table, record);
    }
    table.add(FieldName{"force", "N", "force [N]"}, forces_N(record));
  } else {
    const std::string long_name = fmt::format("{} [{}]", quantity.name, quantity.unit);
    table.add(FieldName{quantity.name, quantity.unit, long_name}, record.raw);
  }
  const DatasetHandle flags =
      table.add(FieldName{"flags", "1", "flags, bit n named by meaning[n] [1]"}, flags_of(record));
  write_attribute(flags.get(), "meaning", kFlagMeaning);
}

void read_raw(hid_t entry, Record& record) {
  const GroupHandle raw = open_group(entry, "raw");
  daq::BoardInfo& board = record.header.board;
  record.scan = read_column<std::int64_t>(raw.get(), "scan");
  if (has(raw.get(), "counts")) {
    board.quantity = daq::RawQuantity::kCounts;
    if (holds<std::uint16_t>(raw.get(), "counts")) {
      read_values<std::uint16_t>(raw.get(), "counts", record);
    } else {
      read_values<std::uint32_t>(raw.get(), "counts", record);
    }
  } else {
    const std::string signal = read_attribute(raw.get(), "signal");
    const auto quantity = quantity_from_name(signal);
    if (!quantity) throw HdfError(fmt::format("raw/@signal '{}' is no quantity of this format", signal));
    board.quantity = *quantity;
    read_values<double>(raw.get(), signal, record);
  }
  if (std::adjacent_find(record.scan.begin(), record.scan.end(), std::greater_equal<>{}) !=
      record.scan.end()) {
    throw HdfError("raw/scan does not rise");
  }
  if (std::any_of(record.raw.begin(), record.raw.end(), [](double value) { return !std::isfinite(value); })) {
    throw HdfError("raw holds values that are not finite");
  }
  const auto flags = read_column<std::uint8_t>(raw.get(), "flags", record.scan.size());
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if ((flags[i] & kSpike) != 0) record.spikes.push_back(record.scan[i]);
  }
}

}  // namespace stickslip::record
