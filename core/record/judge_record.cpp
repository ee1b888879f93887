#include <fmt/format.h>

#include <new>
#include <optional>

#include "core/record/hdf_driver.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/journal.hpp"
#include "core/record/judge.hpp"
#include "core/record/layout.hpp"
#include "core/record/seal.hpp"

namespace stickslip::record {
namespace {

/// Runs one step; what it cannot read is damage. \return whether it could.
template <typename Step>
bool attempt(const char* place, Verdict& verdict, const Step& step) {
  try {
    step();
    return true;
  } catch (const std::bad_alloc&) {
    throw;  // That is no damage.
  } catch (const std::exception& error) {
    verdict.damage(place, error.what());
    return false;
  }
}

/// Says of what kind and version the file is. \return whether it can be judged any further.
bool judge_format(hid_t file, Verdict& verdict) {
  std::optional<std::string> format;
  if (!attempt("file", verdict, [&] { format = find_attribute(file, "format"); })) {
    verdict.kind = "record";
    return false;
  }
  if (format != kFormat) {
    verdict.note("file", format ? fmt::format("is a {}, no record of a test", *format)
                                : "is an HDF5 file but no record of this program");
    return false;
  }
  verdict.kind = "record";
  if (!attempt("format_version", verdict, [&] {
        verdict.format_version = find_number_attribute<std::int64_t>(file, "format_version");
        if (!verdict.format_version) throw HdfError("is missing");
      })) {
    return false;
  }
  const std::string refusal = version_refusal(*verdict.format_version);
  if (refusal.empty()) return true;
  verdict.kind.clear();
  verdict.note("format_version", refusal);
  return false;
}

void judge_seal(hid_t entry, const GivenFile& given, Verdict& verdict) {
  switch (check_seal(entry, given)) {
    case Seal::kSound:
      break;
    case Seal::kBroken:
      verdict.damage("file", "is not as it was published: process/file_sha256 does not match");
      break;
    case Seal::kOpen:
      verdict.incomplete("file", "was never finished: no checksum in process/file_sha256");
      break;
    case Seal::kNone:
      verdict.note("file", "was made before records had a checksum of the whole file");
      break;
  }
}

void judge_count(hid_t entry, Verdict& verdict) {
  const GroupHandle process = open_group(entry, "process");
  if (has(process.get(), "scan_count"))
    verdict.scans_committed = read_scalar<std::int64_t>(process.get(), "scan_count");
  if (verdict.scans_committed && verdict.scans_committed != verdict.scans_present) {
    verdict.damage("process/scan_count", fmt::format("{} scans were committed, {} are here",
                                                     *verdict.scans_committed, *verdict.scans_present));
  }
}

void judge_content(hid_t entry, Verdict& verdict) {
  Record record;
  record.end.emplace();
  bool known = attempt("entry/raw", verdict, [&] { read_quantity(entry, record.header.board); });
  known = attempt("entry", verdict, [&] { read_identity(entry, record); }) && known;
  known = attempt("entry/instrument", verdict,
                  [&] {
                    read_instrument(entry, record);
                    read_second_channel(entry, record);
                  }) &&
          known;
  known = attempt("entry/cycles, gaps, events", verdict, [&] { read_tables(entry, record); }) && known;
  attempt("entry/results", verdict, [&] { record.end->results = read_results(entry); });
  if (has(entry, "truth")) attempt("entry/truth", verdict, [&] { check_truth(entry); });
  if (attempt("entry/process", verdict, [&] { read_process(entry, record); }))
    judge_status(*record.end, verdict);
  if (known) {
    judge_facts(record.header, verdict);
    judge_gaps(record.gaps, verdict);
  }
  if (known && attempt("entry/raw", verdict, [&] { judge_raw(entry, record, verdict); })) {
    verdict.sha256_stored = record.sha256;
    if (verdict.sha256_found != verdict.sha256_stored)
      verdict.damage("process/sha256", "is that of other raw values");
    attempt("process/scan_count", verdict, [&] { judge_count(entry, verdict); });
  }
}

}  // namespace

void judge_record(const GivenFile& given, const std::filesystem::path& path, Verdict& verdict) {
  try {
    if (!is_hdf5(given)) {
      verdict.note("file", "is neither an HDF5 file nor a journal: no record");
      // A record that lost its first bytes is damaged, not a stranger.
      if (path.extension() == kRecordExtension) {
        verdict.kind = "record";
        verdict.damage("file", "is named as a record and does not begin as one: cut short or overwritten");
      }
      return;
    }
    std::optional<FileHandle> opened;
    try {
      opened = open_hdf5(given, path);
    } catch (const HdfError&) {
      verdict.kind = "record";
      verdict.damage("file", "is an HDF5 file but cut short or damaged");
      return;
    }
    const FileHandle& file = *opened;
    if (!judge_format(file.get(), verdict)) return;
    judge_chunks(file.get(), verdict);
    attempt("entry", verdict, [&] {
      const GroupHandle entry = open_group(file.get(), "entry");
      attempt("process/file_sha256", verdict, [&] { judge_seal(entry.get(), given, verdict); });
      judge_content(entry.get(), verdict);
    });
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    verdict.kind = "record";
    verdict.damage("file", error.what());
  }
}

}  // namespace stickslip::record
