#include <fmt/format.h>

#include <string>

#include "core/record/journal.hpp"
#include "core/record/journal_entries.hpp"
#include "core/record/judge.hpp"

namespace stickslip::record {
namespace {

std::string place_of(const UnreadBytes& bytes) { return fmt::format("byte {}", bytes.first); }

std::string text_of(const UnreadBytes& bytes) {
  return fmt::format("{} bytes are not readable: {}", bytes.size, bytes.why);
}

/// There is no header, or none that this program reads.
void judge_unread(const std::filesystem::path& path, const base::Error& error, Verdict& verdict) {
  auto entries = JournalEntries::open(path);
  const bool has_entries = entries && entries->next();
  if (!entries || !entries->error().empty() || (has_entries && error.kind == base::ErrorKind::kUsage)) {
    verdict.kind.clear();
    verdict.note("file", error.message);
  } else if (has_entries) {
    verdict.damage("header", "is damaged: nothing can be made of the whole entries behind it");
  } else if (entries->skipped().empty()) {
    verdict.incomplete("header", "is not whole: the program stopped before anything was recorded");
  } else {
    verdict.damage("header", "is damaged, no whole entry follows it");
  }
}

}  // namespace

void judge_journal(const std::filesystem::path& path, Verdict& verdict) {
  verdict.kind = "journal";
  const auto reading = read_journal(path, JournalScans::kCount);
  if (!reading) return judge_unread(path, reading.error(), verdict);
  const Record& record = reading->record;
  verdict.format_version = reading->format_version;
  verdict.scans_present = static_cast<std::int64_t>(reading->scan_count);
  for (const UnreadBytes& bytes : reading->damaged) verdict.damage(place_of(bytes), text_of(bytes));
  if (reading->torn_end)
    verdict.incomplete(place_of(*reading->torn_end), text_of(*reading->torn_end) + ", as a stop leaves it");
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
