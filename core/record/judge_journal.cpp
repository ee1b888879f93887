#include <fmt/format.h>

#include <string>

#include "core/record/journal.hpp"
#include "core/record/journal_care.hpp"
#include "core/record/judge.hpp"

namespace stickslip::record {
void judge_journal(const std::filesystem::path& path, Verdict& verdict) {
  verdict.kind = "journal";
  const auto reading = read_journal(path, JournalScans::kCount);
  if (!reading && reading.error().kind == base::ErrorKind::kFailure) {
    verdict.kind.clear();  // It was not the content that kept it from being read.
    verdict.note("file", reading.error().message);
    return;
  }
  if (!reading) {
    if (has_entry_behind(path, 0)) {
      verdict.damage("header", "cannot be read, whole entries follow it");
    } else {
      verdict.incomplete("header", "is not whole: the program stopped before anything was recorded");
    }
    return;
  }
  const Record& record = reading->record;
  verdict.format_version = kFormatVersion;
  verdict.scans_present = static_cast<std::int64_t>(reading->scan_count);
  if (!reading->stopped_by.empty()) {
    const std::string what =
        fmt::format("{} of {} bytes are not readable: {}", reading->file_size - reading->whole_size,
                    reading->file_size, reading->stopped_by);
    const std::string place = fmt::format("byte {}", reading->whole_size);
    if (has_entry_behind(path, reading->whole_size)) {
      verdict.damage(place, what + ", whole entries follow");
    } else {
      verdict.incomplete(place, what + ", as a stop leaves it");
    }
  }
  if (record.end) {
    judge_status(*record.end, verdict);
    verdict.incomplete("file", "is the journal of a test that ended; stickslip recover makes its record");
  } else {
    verdict.incomplete("file",
                       "is the journal of a test that has not ended: it runs, or the program was "
                       "stopped; stickslip recover makes its record");
  }
  judge_gaps(record.gaps, verdict);
  judge_facts(record.header, verdict);
  if (!reading->runs.empty())
    judge_clocks(record, reading->runs.front().first, reading->runs.back().end(), verdict);
}

}  // namespace stickslip::record
