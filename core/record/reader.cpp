#include "core/record/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <new>
#include <utility>

#include "core/base/wording.hpp"
#include "core/record/given_file.hpp"
#include "core/record/hdf_driver.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/layout.hpp"

namespace stickslip::record {
namespace {

FileHandle open_record(const GivenFile& given, const std::filesystem::path& path) {
  if (!is_hdf5(given)) throw HdfError("is no HDF5 file: a record ends in .h5 and comes from this program");
  try {
    return open_hdf5(given, path);
  } catch (const HdfError&) {
    throw HdfError("is an HDF5 file but cut short or damaged: take it from a backup");
  }
}

void check_format(const FileHandle& file) {
  if (find_attribute(file.get(), "format") != kFormat) {
    throw HdfError("is an HDF5 file but no record of this program: attribute format is not stickslip-record");
  }
  const auto version = find_number_attribute<std::int64_t>(file.get(), "format_version");
  if (!version) throw HdfError("is a record without format version");
  if (const std::string refusal = version_refusal(*version); !refusal.empty()) throw HdfError(refusal);
}

struct OpenEntry {
  FileHandle file;
  GroupHandle entry;  ///< Closed before the file.
};

OpenEntry open_entry(const GivenFile& given, const std::filesystem::path& path) {
  FileHandle file = open_record(given, path);
  check_format(file);
  GroupHandle entry = open_group(file.get(), "entry");
  return {std::move(file), std::move(entry)};
}

/// No journal of counts begins without it, not even the one in memory that a reader's process answers with.
void check_gain(const RecordHeader& header) {
  if (header.board.quantity == daq::RawQuantity::kCounts && !header.load_cell) {
    throw HdfError(
        "instrument/calibration/gain is missing, counts mean nothing without: take the record from a backup");
  }
}

/// Fields without which nothing can be computed from the raw values.
void check_facts(const Record& record) {
  const daq::BoardInfo& board = record.header.board;
  if (!(board.scan_rate_granted_Hz > 0.0) || !std::isfinite(board.scan_rate_granted_Hz)) {
    throw HdfError(fmt::format("timing/scan_rate_granted {} Hz is not positive", board.scan_rate_granted_Hz));
  }
  check_gain(record.header);
  if (board.polynomial.empty())
    throw HdfError("instrument/adc/polynomial is missing, counts mean nothing without");
  if (board.quantity == daq::RawQuantity::kCounts &&
      std::any_of(record.raw.begin(), record.raw.end(),
                  [&](double count) { return count > static_cast<double>(board.maxdata); })) {
    throw HdfError("raw/counts exceed instrument/adc/maxdata");
  }
  if (sha256_of_raw(record) != record.sha256) {
    throw HdfError("raw values do not match process/sha256: damaged or altered");
  }
}

/// All but the columns.
Record facts_in(hid_t entry, std::span<const std::string> only_results = {}) {
  Record record;
  record.end.emplace();
  read_quantity(entry, record.header.board);
  read_identity(entry, record);
  read_instrument(entry, record);
  read_second_channel(entry, record);
  record.end->results = read_results(entry, only_results);
  read_process(entry, record);
  return record;
}

Record read_facts_of(const GivenFile& given, const std::filesystem::path& path) {
  const auto [file, entry] = open_entry(given, path);
  Record record = facts_in(entry.get());
  check_gain(record.header);
  return record;
}

Record read_whole(const GivenFile& given, const std::filesystem::path& path) {
  const auto [file, entry] = open_entry(given, path);
  Record record = facts_in(entry.get());
  read_raw(entry.get(), record);
  read_second(entry.get(), record);
  read_tables(entry.get(), record);
  if (has(entry.get(), "truth")) {
    record.end->truth = read_truth(entry.get());
    record.true_coefficient = read_true_coefficient(entry.get(), record.scan.size());
  }
  check_facts(record);
  return record;
}

Record read_shortened(const GivenFile& given, const std::filesystem::path& path,
                      std::span<const std::string> only_results) {
  const auto [file, entry] = open_entry(given, path);
  Record record = facts_in(entry.get(), only_results);
  read_raw_values(entry.get(), record);
  check_facts(record);
  record.raw.clear();
  read_cycles(entry.get(), record);
  if (has(entry.get(), "truth")) record.end->truth = read_truth_facts(entry.get());
  return record;
}

void verify(const GivenFile& given, const std::filesystem::path& path, const Record& record,
            const ScanSource& scans) {
  const auto [file, entry] = open_entry(given, path);
  const Record back = facts_in(entry.get());
  if (back.header.board.quantity != record.header.board.quantity) throw HdfError("holds another quantity");
  if (back.header.board.second != record.header.board.second) throw HdfError("holds another second channel");
  verify_second(entry.get(), record, scans);
  check_tables(entry.get());
  if (has(entry.get(), "truth")) check_truth(entry.get());
  verify_scans(entry.get(), record.header.board, scans);
}

/// Of an exception while a file was read.
base::Error why_not(const GivenFile& given, const std::filesystem::path& path, const std::exception& error) {
  const bool no_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  if (const int refused = no_memory ? ENOMEM : given.refused(); refused != 0)
    return base::failure("{}: {}", path.string(), why_unreadable(refused)).value();
  return base::usage_error("{}: {}", path.string(), base::reason_of(error)).value();
}

base::Error of_file(const std::filesystem::path& path, const base::Error& error) {
  return {error.kind, fmt::format("{}: {}", path.string(), error.message)};
}

template <typename Read>
base::Result<Record> read_by(const Read& read, const std::filesystem::path& path, const FileCalls& calls) {
  const auto given = open_shared(path, calls);
  if (!given) return tl::unexpected(of_file(path, given.error()));
  try {
    return read(*given, path);
  } catch (const std::exception& error) {
    return tl::unexpected(why_not(*given, path, error));
  }
}

}  // namespace

base::Result<Record> read_record(const std::filesystem::path& path, const FileCalls& calls) {
  return read_by(read_whole, path, calls);
}

base::Result<Record> read_without_scans(const std::filesystem::path& path, std::span<const std::string> only,
                                        const FileCalls& calls) {
  const auto read = [only](const GivenFile& given, const std::filesystem::path& file) {
    return read_shortened(given, file, only);
  };
  return read_by(read, path, calls);
}

base::Result<Record> read_facts(const std::filesystem::path& path, const FileCalls& calls) {
  return read_by(read_facts_of, path, calls);
}

base::Result<void> verify_record(const std::filesystem::path& path, const Record& record,
                                 const ScanSource& scans, const FileCalls& calls) {
  const auto given = open_shared(path, calls);
  if (!given) return tl::unexpected(of_file(path, {base::ErrorKind::kFailure, given.error().message}));
  try {
    verify(*given, path, record, scans);
    return {};
  } catch (const HdfError& error) {
    return tl::unexpected(why_not(*given, path, error));
  } catch (const std::runtime_error& error) {
    // Of the source: nothing is known against the file.
    return base::failure("{}: cannot be compared with its scans now: {}: try again", path.string(),
                         base::reason_of(error));
  } catch (const std::exception& error) {
    return tl::unexpected(why_not(*given, path, error));
  }
}

}  // namespace stickslip::record
