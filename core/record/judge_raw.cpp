#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <vector>

#include "core/daq/calibration.hpp"
#include "core/record/enum_names.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/judge.hpp"
#include "core/record/layout.hpp"
#include "core/record/range_check.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::record {
namespace {

/// Says once what may be wrong in a million rows.
class Once {
 public:
  explicit Once(Verdict& verdict) : verdict_(verdict) {}
  void damage(const char* column, std::size_t row, const std::string& text) {
    if (!said_.empty() && std::find(said_.begin(), said_.end(), text) != said_.end()) return;
    said_.push_back(text);
    verdict_.damage(fmt::format("entry/raw/{} row {}", column, row), text);
  }

 private:
  Verdict& verdict_;
  std::vector<std::string> said_;
};

/// Jumps of the index against the table of gaps.
class Jumps {
 public:
  explicit Jumps(std::vector<daq::Gap> gaps) : gaps_(std::move(gaps)) {
    std::sort(gaps_.begin(), gaps_.end(),
              [](const daq::Gap& a, const daq::Gap& b) { return a.first < b.first; });
  }

  /// Whether gaps cover [first, end) exactly.
  [[nodiscard]] bool explained(daq::ScanIndex first, daq::ScanIndex end) const {
    auto gap = std::lower_bound(gaps_.begin(), gaps_.end(), first,
                                [](const daq::Gap& a, daq::ScanIndex scan) { return a.first < scan; });
    for (; gap != gaps_.end() && gap->first == first && first < end; ++gap) first += gap->count;
    return first == end;
  }

 private:
  std::vector<daq::Gap> gaps_;
};

template <typename Stored>
void judge_columns(hid_t raw, const std::string& name, const Record& record, Verdict& verdict) {
  const daq::BoardInfo& board = record.header.board;
  const bool counts = board.quantity == daq::RawQuantity::kCounts;
  const std::size_t size = row_count(raw, name);
  for (const char* column : {"time", "scan", "flags"}) {
    if (row_count(raw, column) != size)
      throw HdfError(fmt::format("{} has another length than {}", column, name));
  }
  const DatasetHandle times = open_dataset(raw, "time");
  const DatasetHandle indices = open_dataset(raw, "scan");
  const DatasetHandle values = open_dataset(raw, name);
  const DatasetHandle flags = open_dataset(raw, "flags");
  std::optional<DatasetHandle> forces;
  const std::optional<daq::Calibration> calibration = force_column(record.header);
  // Imported records of 0.1 have none.
  if (calibration && (counts || has(raw, "force"))) {
    if (row_count(raw, "force") != size)
      throw HdfError(fmt::format("force has another length than {}", name));
    forces.emplace(open_dataset(raw, "force"));
  }
  Once once{verdict};
  const Jumps jumps{record.gaps};
  Sha256 sha;
  std::optional<daq::ScanIndex> origin;
  daq::ScanIndex next = 0;
  const auto maxdata = static_cast<double>(board.maxdata);
  for (std::size_t row = 0; row < size; row += ScanSource::kPiece) {
    const std::size_t count = std::min(ScanSource::kPiece, size - row);
    std::vector<double> time_s(count);
    std::vector<std::int64_t> scan(count);
    std::vector<Stored> value(count);
    std::vector<std::uint8_t> flag(count);
    std::vector<float> force_N(forces ? count : 0);
    read_rows<double>(times, "time", row, time_s);
    read_rows<std::int64_t>(indices, "scan", row, scan);
    for (const daq::ScanIndex index : scan) range_checked(index);
    read_rows<Stored>(values, name, row, value);
    read_rows<std::uint8_t>(flags, "flags", row, flag);
    if (forces) read_rows<float>(*forces, "force", row, force_N);
    sha.add(std::span<const Stored>{value});
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t at = row + i;
      if (!origin) {
        next = scan[i];
        origin = scan[i];
      }
      if (scan[i] < next) once.damage("scan", at, "the scans do not rise");
      if (scan[i] > next && !jumps.explained(next, scan[i]))
        once.damage("scan", at, "the scans jump where gaps/first_scan has no gap");
      next = scan[i] + 1;
      if (time_s[i] != static_cast<double>(scan[i] - *origin) / board.scan_rate_granted_Hz)
        once.damage("time", at, "the time is not that of the scan");
      const auto reading = static_cast<double>(value[i]);
      if (!std::isfinite(reading) || (counts && reading > maxdata))
        once.damage(name.c_str(), at, "is no reading of this board");
      if (forces && force_N[i] != static_cast<float>(calibration->force_N(reading)))
        once.damage("force", at, "the force does not follow from the raw values");
      const bool saturated = counts && (reading <= 0.0 || reading >= maxdata);
      if (((flag[i] & kSaturated) != 0) != saturated)
        once.damage("flags", at, "saturation does not follow from the counts");
    }
  }
  verdict.scans_present = static_cast<std::int64_t>(size);
  verdict.sha256_found = sha.hexadecimal();
  if (origin) judge_clocks(record, *origin, next, verdict);
}

void judge_second(hid_t raw, const daq::SecondChannel& channel, std::int64_t size, Verdict& verdict) {
  const std::string name{daq::name(channel.quantity)};
  const std::string counts = name + "_counts";
  if (!has(raw, counts)) return;
  for (const std::string& column : {name, counts}) {
    if (static_cast<std::int64_t>(row_count(raw, column)) != size)
      throw HdfError(fmt::format("{} has another length than scan", column));
  }
  const DatasetHandle codes = open_dataset(raw, counts);
  const DatasetHandle values = open_dataset(raw, name);
  Once once{verdict};
  for (std::size_t row = 0; row < static_cast<std::size_t>(size); row += ScanSource::kPiece) {
    const std::size_t count = std::min(ScanSource::kPiece, static_cast<std::size_t>(size) - row);
    std::vector<std::int32_t> code(count);
    std::vector<float> value(count);
    read_rows<std::int32_t>(codes, counts, row, code);
    read_rows<float>(values, name, row, value);
    for (std::size_t i = 0; i < count; ++i) {
      if (code[i] < daq::SecondChannel::kNoCode || code[i] > static_cast<std::int64_t>(channel.maxdata))
        once.damage(counts.c_str(), row + i, "is no code of the second channel");
      const auto expected = static_cast<float>(channel.value(code[i]));
      if (value[i] != expected && !(std::isnan(value[i]) && std::isnan(expected)))
        once.damage(name.c_str(), row + i, "does not follow from the codes");
    }
  }
}

}  // namespace

void judge_raw(hid_t entry, const Record& record, Verdict& verdict) {
  const GroupHandle raw = open_group(entry, "raw");
  if (record.header.board.quantity != daq::RawQuantity::kCounts) {
    judge_columns<double>(raw.get(), std::string{name(record.header.board.quantity).name}, record, verdict);
  } else if (holds<std::uint16_t>(raw.get(), "counts")) {
    judge_columns<std::uint16_t>(raw.get(), "counts", record, verdict);
  } else {
    judge_columns<std::uint32_t>(raw.get(), "counts", record, verdict);
  }
  if (record.header.board.second) {
    judge_second(raw.get(), *record.header.board.second, verdict.scans_present.value_or(0), verdict);
  }
}

}  // namespace stickslip::record
