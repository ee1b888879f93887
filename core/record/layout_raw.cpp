#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <utility>

#include "core/daq/calibration.hpp"
#include "core/record/enum_names.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/range_check.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::record {
namespace {

const std::vector<std::string> kFlagMeaning{"spike", "saturated", "replaced_for_detection"};

/// The flags of scans that rise from piece to piece.
class Flags {
 public:
  explicit Flags(const Record& record)
      : board_(record.header.board), spike_(record.spikes.begin()), spikes_end_(record.spikes.end()) {}

  [[nodiscard]] std::vector<std::uint8_t> of(const ScanPiece& piece) {
    std::vector<std::uint8_t> flags(piece.scan.size(), 0);
    const bool counts = board_.quantity == daq::RawQuantity::kCounts;
    const auto maxdata = static_cast<double>(board_.maxdata);
    for (std::size_t i = 0; i < flags.size(); ++i) {
      while (spike_ != spikes_end_ && *spike_ < piece.scan[i]) ++spike_;
      if (spike_ != spikes_end_ && *spike_ == piece.scan[i]) flags[i] = kSpike | kReplacedForDetection;
      if (counts && (piece.raw[i] <= 0.0 || piece.raw[i] >= maxdata)) flags[i] |= kSaturated;
    }
    return flags;
  }

 private:
  const daq::BoardInfo& board_;
  std::vector<daq::ScanIndex>::const_iterator spike_;
  std::vector<daq::ScanIndex>::const_iterator spikes_end_;
};

/// The values in the type of the file, and nothing else than all of them in one digest.
template <typename Stored>
class ValueWriter {
 public:
  explicit ValueWriter(ColumnWriter<Stored> column) : column_(std::move(column)) {}

  void append(std::span<const double> raw) {
    const std::vector<Stored> stored(raw.begin(), raw.end());
    column_.append(stored);
    sha_.add(std::span<const Stored>{stored});
  }
  [[nodiscard]] std::string sha256() { return sha_.hexadecimal(); }

 private:
  ColumnWriter<Stored> column_;
  Sha256 sha_;
};

/// Columns before and after the values are the same for every board.
template <typename Stored>
std::string write_columns(TableWriter& table, const Record& record, const ScanSource& scans,
                          const std::function<void()>& take_end, const FieldName& value_name) {
  const daq::BoardInfo& board = record.header.board;
  const bool counts = board.quantity == daq::RawQuantity::kCounts;
  const std::size_t size = scans.size();
  auto times = table.add_empty<double>(FieldName{"time", "s", "time after the first scan [s]"}, size);
  auto indices =
      table.add_empty<std::int64_t>(FieldName{"scan", "1", "scan index of the acquisition [1]"}, size);
  auto value_column = table.add_empty<Stored>(value_name, size);
  if (counts) write_number_attribute(value_column.dataset().get(), "maxdata", board.maxdata);
  std::optional<ColumnWriter<float>> forces;
  const std::optional<daq::Calibration> calibration = force_column(record.header);
  if (calibration) {
    forces.emplace(table.add_empty<float>(FieldName{"force", "N", "force [N]"}, size));
  }
  auto flag_column =
      table.add_empty<std::uint8_t>(FieldName{"flags", "1", "flags, bit n named by meaning[n] [1]"}, size);
  write_attribute(flag_column.dataset().get(), "meaning", kFlagMeaning);

  ValueWriter<Stored> values{std::move(value_column)};
  std::optional<Flags> flags{record};
  std::optional<daq::ScanIndex> first;
  scans.for_each_piece([&](const ScanPiece& piece) {
    if (!first) first = piece.scan.front();
    std::vector<double> time_s;
    for (const daq::ScanIndex scan : piece.scan) {
      time_s.push_back(static_cast<double>(scan - *first) / board.scan_rate_granted_Hz);
    }
    times.append(time_s);
    indices.append(piece.scan);
    values.append(piece.raw);
    if (forces) {
      std::vector<float> force_N;
      for (const double raw : piece.raw) force_N.push_back(static_cast<float>(calibration->force_N(raw)));
      forces->append(force_N);
    }
    if (!take_end) flag_column.append(flags->of(piece));
  });
  if (take_end) {
    take_end();
    flags.emplace(record);
    scans.for_each_piece([&](const ScanPiece& piece) { flag_column.append(flags->of(piece)); });
  }
  return values.sha256();
}

template <typename Stored>
void read_values(hid_t raw, const std::string& name, Record& record) {
  const auto values = read_column<Stored>(raw, name, row_count(raw, "scan"));
  record.raw.assign(values.begin(), values.end());
}

constexpr const char* kOtherScans = "holds other scans";

template <typename Stored>
void verify_columns(hid_t raw, const std::string& name, const ScanSource& scans) {
  const DatasetHandle indices = open_dataset(raw, "scan");
  const DatasetHandle values = open_dataset(raw, name);
  if (row_count(raw, "scan") != scans.size() || row_count(raw, name) != scans.size()) {
    throw HdfError(kOtherScans);
  }
  std::size_t row = 0;
  scans.for_each_piece([&](const ScanPiece& piece) {
    std::vector<std::int64_t> scan(piece.scan.size());
    std::vector<Stored> stored(piece.raw.size());
    read_rows<std::int64_t>(indices, "scan", row, scan);
    read_rows<Stored>(values, name, row, stored);
    const std::vector<double> back(stored.begin(), stored.end());
    if (!std::equal(scan.begin(), scan.end(), piece.scan.begin()) ||
        std::memcmp(back.data(), piece.raw.data(), piece.raw.size_bytes()) != 0) {
      throw HdfError(kOtherScans);
    }
    row += piece.scan.size();
  });
}

}  // namespace

std::optional<daq::Calibration> force_column(const RecordHeader& header) {
  constexpr double kAnyLoad_N = 1.0;  // A force by a load cell does not depend on it.
  switch (header.board.quantity) {
    case daq::RawQuantity::kCounts:
    case daq::RawQuantity::kVolts:
      if (header.load_cell) return daq::Calibration{header.board, *header.load_cell, kAnyLoad_N};
      break;
    case daq::RawQuantity::kCoefficient:
      if (header.tester.sled_mass_kg)
        return daq::Calibration{header.board, {}, header.tester.tester().normal_load_N()};
      break;
    case daq::RawQuantity::kForce_N:
      break;
  }
  return std::nullopt;
}

std::string write_raw(hid_t entry, const Record& record, const ScanSource& scans,
                      const std::function<void()>& take_end) {
  const daq::BoardInfo& board = record.header.board;
  const bool counts = board.quantity == daq::RawQuantity::kCounts;
  const QuantityName quantity = name(board.quantity);

  TableWriter table{make_group(entry, "raw", "NXdata")};
  write_attribute(table.group(), "signal", counts ? "force" : quantity.name);
  write_attribute(table.group(), "axes", std::vector<std::string>{"time"});
  if (counts) {
    const FieldName column{"counts", "1", "A/D code [1]"};
    return counts_fit_u16(board) ? write_columns<std::uint16_t>(table, record, scans, take_end, column)
                                 : write_columns<std::uint32_t>(table, record, scans, take_end, column);
  }
  const std::string long_name = fmt::format("{} [{}]", quantity.name, quantity.unit);
  return write_columns<double>(table, record, scans, take_end,
                               FieldName{quantity.name, quantity.unit, long_name});
}

std::string sha256_of_raw(const Record& record) {
  constexpr std::size_t kPiece = std::size_t{1} << 16U;
  Sha256 sha;
  for (std::size_t from = 0; from < record.raw.size(); from += kPiece) {
    const auto raw =
        std::span<const double>{record.raw}.subspan(from, std::min(kPiece, record.raw.size() - from));
    if (record.header.board.quantity != daq::RawQuantity::kCounts) {
      sha.add(raw);
    } else if (counts_fit_u16(record.header.board)) {
      sha.add(std::span<const std::uint16_t>{std::vector<std::uint16_t>(raw.begin(), raw.end())});
    } else {
      sha.add(std::span<const std::uint32_t>{std::vector<std::uint32_t>(raw.begin(), raw.end())});
    }
  }
  return sha.hexadecimal();
}

void read_quantity(hid_t entry, daq::BoardInfo& board) {
  const GroupHandle raw = open_group(entry, "raw");
  if (has(raw.get(), "counts")) {
    board.quantity = daq::RawQuantity::kCounts;
    return;
  }
  const std::string signal = read_attribute(raw.get(), "signal");
  const auto quantity = quantity_from_name(signal);
  if (!quantity) throw HdfError(fmt::format("raw/@signal '{}' is no quantity of this format", signal));
  board.quantity = *quantity;
}

void read_raw_values(hid_t entry, Record& record) {
  const GroupHandle raw = open_group(entry, "raw");
  const daq::RawQuantity quantity = record.header.board.quantity;
  if (quantity != daq::RawQuantity::kCounts) {
    read_values<double>(raw.get(), std::string{name(quantity).name}, record);
  } else if (holds<std::uint16_t>(raw.get(), "counts")) {
    read_values<std::uint16_t>(raw.get(), "counts", record);
  } else {
    read_values<std::uint32_t>(raw.get(), "counts", record);
  }
  if (std::any_of(record.raw.begin(), record.raw.end(), [](double value) { return !std::isfinite(value); })) {
    throw HdfError("raw holds values that are not finite");
  }
}

void read_raw(hid_t entry, Record& record) {
  read_quantity(entry, record.header.board);
  read_raw_values(entry, record);
  const GroupHandle raw = open_group(entry, "raw");
  record.scan = read_column<std::int64_t>(raw.get(), "scan", record.raw.size());
  for (const daq::ScanIndex scan : record.scan) range_checked(scan);
  if (std::adjacent_find(record.scan.begin(), record.scan.end(), std::greater_equal<>{}) !=
      record.scan.end()) {
    throw HdfError("raw/scan does not rise");
  }
  if (!has(raw.get(), "flags")) return;
  const auto flags = read_column<std::uint8_t>(raw.get(), "flags", record.scan.size());
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if ((flags[i] & kSpike) != 0) record.spikes.push_back(record.scan[i]);
  }
}

void verify_scans(hid_t entry, const daq::BoardInfo& board, const ScanSource& scans) {
  const GroupHandle raw = open_group(entry, "raw");
  if (board.quantity != daq::RawQuantity::kCounts) {
    verify_columns<double>(raw.get(), std::string{name(board.quantity).name}, scans);
  } else if (counts_fit_u16(board)) {
    verify_columns<std::uint16_t>(raw.get(), "counts", scans);
  } else {
    verify_columns<std::uint32_t>(raw.get(), "counts", scans);
  }
  if (!scans.has_force() || !has(entry, "truth")) return;
  const GroupHandle truth = open_group(entry, "truth");
  const DatasetHandle column = open_dataset(truth.get(), "coefficient");
  if (row_count(column, "coefficient") != scans.size()) throw HdfError(kOtherScans);
  std::size_t row = 0;
  scans.for_each_force_piece([&](std::span<const double> force) {
    std::vector<double> back(force.size());
    read_rows<double>(column, "coefficient", row, back);
    if (std::memcmp(back.data(), force.data(), force.size_bytes()) != 0) throw HdfError(kOtherScans);
    row += force.size();
  });
}

}  // namespace stickslip::record
