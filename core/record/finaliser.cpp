#include "core/record/finaliser.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <exception>
#include <future>
#include <utility>

#include "core/base/contract.hpp"
#include "core/record/file.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/journal.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/layout.hpp"
#include "core/record/reader.hpp"
#include "core/record/seal.hpp"

namespace stickslip::record {
namespace {

void link(hid_t from, const char* name, hid_t to) {
  check(H5Lcreate_hard(from, name, to, name, H5P_DEFAULT, H5P_DEFAULT), std::string{"link to "} + name);
}

/// A second way to what has no texts: GNU Octave gives up a whole group for one UTF-8 text in it.
void write_numbers(hid_t file, hid_t entry) {
  const GroupHandle numbers = make_group(file, "numbers", "NXcollection");
  for (const char* table : {"raw", "cycles"}) link(entry, table, numbers.get());
  const GroupHandle from = open_group(entry, "results");
  const GroupHandle to = make_group(numbers.get(), "results", "NXcollection");
  link(from.get(), kDiagnostics, to.get());
  const analysis::TestResults names;
  analysis::for_each_result(names, [&](const analysis::ResultName& name, const auto&) {
    if (!name.is_diagnostic) link(from.get(), std::string{name.name}.c_str(), to.get());
  });
}

/// Sets the rest of record.end; throws if there is none.
using TakeEnd = std::function<void()>;

/// \throws HdfError with the file in an unknown state: it is to be thrown away.
void build(const Record& record, const ScanSource& scans, const TakeEnd& take_end,
           const std::filesystem::path& path, const FileCalls& calls) {
  FileHandle file = create_file(path, calls);
  write_attribute(file.get(), "NX_class", "NXroot");
  write_attribute(file.get(), "default", "entry");
  write_attribute(file.get(), "creator", record.header.process.program);
  write_attribute(file.get(), "creator_version", record.header.process.version);
  write_attribute(file.get(), "format", kFormat);
  write_number_attribute(file.get(), "format_version", kFormatVersion);
  {
    const GroupHandle entry = make_group(file.get(), "entry", "NXentry");
    write_attribute(entry.get(), "default", "raw");
    write_identity(entry.get(), record, scans);
    const std::string sha256 = write_raw(entry.get(), record, scans, take_end);
    write_results(entry.get(), record.end->results);
    write_tables(entry.get(), record);
    write_instrument(entry.get(), record);
    write_second(entry.get(), record, scans);
    write_process(entry.get(), record, sha256);
    write_seal(entry.get(), scans.size());
    if (record.end->truth) write_truth(entry.get(), *record.end->truth, scans);
    write_numbers(file.get(), entry.get());
  }
  finish_file(std::move(file));
}

base::Result<void> build_verified(const Record& record, const ScanSource& scans, const TakeEnd& take_end,
                                  const std::filesystem::path& part, const FileCalls& calls) {
  try {
    build(record, scans, take_end, part, calls);
  } catch (const std::exception& error) {
    return base::failure("{}: cannot be written: {}", part.string(), error.what());
  }
  // Synced before it is read back, so that what is compared is what a disk can keep.
  if (auto sealed = seal_file(part, calls); !sealed) return sealed;
  auto verified = verify_record(part, record, scans, calls);
  // A difference in a file just written is a failure, not a usage error.
  if (!verified) verified.error().kind = base::ErrorKind::kFailure;
  return verified;
}

std::filesystem::path with_suffix(std::filesystem::path path, const std::string& suffix) {
  path += suffix;
  return path;
}

bool is_there(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(path, ignored));
}

/// Whether the path is an empty regular file: a stop within rename_to_new() leaves one on file systems
/// without hard links.
bool is_empty_file(const std::filesystem::path& path) {
  struct stat found {};
  return ::lstat(path.c_str(), &found) == 0 && S_ISREG(found.st_mode) && found.st_size == 0;
}

base::Result<void> check_new(const std::filesystem::path& path) {
  if (!is_there(path)) return {};
  return base::usage_error("{}: exists already and is never overwritten: choose another name", path.string());
}

void end_interrupted(JournalReading& reading, const Evaluate& evaluate) {
  Record& record = reading.record;
  EndRecord end;
  if (evaluate) {
    end = evaluate(record);
  } else {
    end.results = absent_results("interrupted");
    end.cycles = record.cycles;
    end.spikes = record.spikes;
  }
  end.status = Status::kInterrupted;
  end.reasons.emplace_back(kInterruptedWhy);
  end.cause = kProgramDied;
  if (!reading.runs.empty()) end.end_realtime_ns = realtime_at(record.header, reading.runs.back().end());
  set_end(record, std::move(end));
}

/// The results in the journal were those of more scans than are left.
void end_damaged(Record& record, const Evaluate& evaluate) {
  EndRecord end = *record.end;
  if (evaluate) {
    EndRecord again = evaluate(record);
    end.results = std::move(again.results);
    end.cycles = std::move(again.cycles);
    end.spikes = std::move(again.spikes);
  } else {
    end.results = absent_results("damaged");
    end.cycles = record.cycles;
    end.spikes = record.spikes;
  }
  if (end.status != Status::kInterrupted) end.status = Status::kIncomplete;
  set_end(record, std::move(end));
}

void tell_unread(const JournalReading& reading, EndRecord& end) {
  if (!reading.damaged.empty()) {
    end.reasons.push_back(fmt::format(
        "{} of {} bytes of the journal could not be read, the first at byte {}: {}; the journal is kept",
        reading.damaged_size(), reading.file_size, reading.damaged.front().first, reading.why_unread()));
  }
  if (reading.torn_end) {
    if (end.status == Status::kComplete) end.status = Status::kRecovered;
    end.reasons.push_back(fmt::format("{} bytes at the end of the journal were not readable: {}",
                                      reading.torn_end->size, reading.torn_end->why));
  }
}

/// Renames a damaged journal to a free name. \return the name.
base::Result<std::filesystem::path> set_aside(const std::filesystem::path& journal, const FileCalls& calls) {
  if (journal.extension() == kDamagedExtension) return journal;
  auto damaged = with_suffix(journal, std::string{kDamagedExtension});
  for (int number = 2; is_there(damaged); ++number)
    damaged = with_suffix(journal, fmt::format(".{}{}", number, kDamagedExtension));
  if (auto renamed = rename_to_new(journal, damaged, calls); !renamed)
    return tl::unexpected(base::Error{base::ErrorKind::kFailure, renamed.error().message});
  return damaged;
}

base::Result<void> publish(const Record& record, const ScanSource& scans, const std::filesystem::path& path,
                           const FileCalls& calls, const TakeEnd& take_end = {}) {
  STICKSLIP_EXPECTS(record.end);
  if (record.header.board.quantity == daq::RawQuantity::kCounts && !record.header.load_cell)
    return base::failure("{}: cannot be made: its counts have no gain of a load cell, and are no force",
                         path.string());
  if (auto is_new = check_new(path); !is_new) return is_new;
  const auto part = with_suffix(path, ".part");
  auto published = build_verified(record, scans, take_end, part, calls);
  if (published) published = rename_to_new(part, path, calls);
  if (!published) calls.unlink(part.c_str());
  return published;
}

base::Result<void> remove_journal(const std::filesystem::path& journal, const FileCalls& calls) {
  if (calls.unlink(journal.c_str()) != 0) {
    return base::failure("{}: cannot be removed: {}", journal.string(), system_message(errno));
  }
  return sync_folder(folder_of(journal), calls);
}

}  // namespace

base::Result<void> check_publishable(const std::filesystem::path& path) {
  if (auto is_new = check_new(path); !is_new) return is_new;
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder_of(path), ignored)) {
    return base::usage_error("{}: there is no folder {}: make it first", path.string(),
                             folder_of(path).string());
  }
  return {};
}

base::Result<void> publish_record(const Record& record, const std::filesystem::path& path) {
  STICKSLIP_EXPECTS(record.scan.size() == record.raw.size());
  STICKSLIP_EXPECTS(record.second.empty() || record.second.size() == record.scan.size());
  STICKSLIP_EXPECTS(record.true_coefficient.empty() || record.true_coefficient.size() == record.scan.size());
  return publish_record(record, RecordScans{record}, path);
}

base::Result<void> publish_record(const Record& record, const ScanSource& scans,
                                  const std::filesystem::path& path) {
  return publish(record, scans, path, system_calls());
}

base::Result<void> publish_record(Record& record, const ScanSource& scans, const std::filesystem::path& path,
                                  const std::function<base::Result<EndRecord>()>& evaluate) {
  base::Result<EndRecord> end;
  std::exception_ptr thrown;
  // Without room for a thread it runs when it is asked.
  std::future<base::Result<EndRecord>> evaluation = std::async(evaluate);
  const auto take_end = [&] {
    try {
      end = evaluation.get();
    } catch (...) {
      thrown = std::current_exception();
    }
    if (thrown || !end) throw HdfError("there are no results");
    set_end(record, *std::move(end));
  };
  auto published = publish(record, scans, path, system_calls(), take_end);
  if (evaluation.valid()) {  // The scans could not be written: what the evaluation finds counts first.
    try {
      if (auto found = evaluation.get(); !found) return tl::unexpected(found.error());
    } catch (...) {
      thrown = std::current_exception();
    }
  }
  if (thrown) std::rethrow_exception(thrown);
  if (!end) return tl::unexpected(end.error());
  return published;
}

base::Result<void> publish_journal(const std::filesystem::path& journal, const Record& record,
                                   const std::filesystem::path& path) {
  const auto reading = read_journal(journal, JournalScans::kCount);
  if (!reading) return tl::unexpected(reading.error());
  if (const std::string why = reading->why_unread(); !why.empty())
    return base::failure("{}: cannot be read back: {}", journal.string(), why);
  return publish(record, JournalScanSource{journal, *reading}, path, system_calls());
}

std::filesystem::path record_of(const std::filesystem::path& journal) {
  std::filesystem::path file = journal;
  if (file.extension() == kDamagedExtension) {
    file.replace_extension();
    if (file.extension() != kJournalExtension) file.replace_extension();  // The number of a second one.
  }
  return file.replace_extension(kRecordExtension);
}

base::Result<Finalised> finalise(const std::filesystem::path& journal, const Evaluate& evaluate,
                                 const FileCalls& calls, std::chrono::milliseconds longest,
                                 std::optional<std::int64_t> expected_scans) {
  const auto lock = JournalLock::take(journal, longest, calls);
  if (!lock) return tl::unexpected(lock.error());
  auto reading = read_journal(journal, JournalScans::kCount, calls);
  if (!reading) return tl::unexpected(reading.error());
  Finalised made{
      record_of(journal), static_cast<std::int64_t>(reading->scan_count), reading->damaged_size(), {}};
  const bool has_fewer = expected_scans && made.scan_count < *expected_scans;
  const bool has_loss = has_fewer || !reading->damaged.empty();
  if (evaluate && (has_loss || !reading->record.end))
    reading = read_journal(journal, JournalScans::kKeep, calls);  // It needs the scans.
  if (!reading) return tl::unexpected(reading.error());
  Record& record = reading->record;
  if (!record.end) {
    end_interrupted(*reading, evaluate);
  } else if (has_loss) {
    end_damaged(record, evaluate);
  }
  if (has_fewer) {
    record.end->reasons.push_back(fmt::format("{} scans were written to the journal, {} could be read",
                                              *expected_scans, made.scan_count));
  }
  tell_unread(*reading, *record.end);

  const JournalScanSource scans{journal, *reading, calls};
  if (is_empty_file(made.file)) calls.unlink(made.file.c_str());
  if (is_there(made.file)) {
    // Left by a stop between the rename and the removal of the journal, or a stranger.
    if (const auto same = verify_record(made.file, record, scans, calls); !same) {
      // It cannot be looked at now: nothing is said of its content, and the journal waits.
      if (same.error().kind == base::ErrorKind::kFailure) return tl::unexpected(same.error());
      return base::failure("{}: exists already with other scans than {}: move one of them away",
                           made.file.string(), journal.string());
    }
    calls.unlink(
        with_suffix(made.file, ".part").c_str());  // Its other name, where it was published by link().
  } else if (auto published = publish(record, scans, made.file, calls); !published) {
    return tl::unexpected(base::Error{base::ErrorKind::kFailure, published.error().message});
  }
  if (!reading->damaged.empty() || (has_fewer && reading->torn_end)) {
    auto kept = set_aside(journal, calls);
    if (!kept) return tl::unexpected(kept.error());
    made.kept = *std::move(kept);
  } else if (auto removed = remove_journal(journal, calls); !removed) {
    return tl::unexpected(removed.error());
  }
  return made;
}

}  // namespace stickslip::record
