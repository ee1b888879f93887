#include "daemon/recovery.hpp"

#include <chrono>
#include <system_error>

#include "core/record/journal_care.hpp"
#include "daemon/finaliser.hpp"

namespace stickslip::daemon {
namespace {

/// A finaliser whose daemon was killed goes on by itself; an hour of scans takes it 0.2 s.
constexpr std::chrono::seconds kOthersTime{10};

/// Somebody else has made the record in the meantime.
bool is_done(const std::filesystem::path& journal) {
  std::error_code ignored;
  return !std::filesystem::exists(journal, ignored) && std::filesystem::exists(record_of(journal), ignored);
}

}  // namespace

bool recover_journal(const std::filesystem::path& journal, const Finalise& finalise, Facts& facts) {
  const base::Result<bool> removed = record::remove_if_empty(journal, kOthersTime);
  if (!removed && is_done(journal)) {
    facts.orphan_finalised(record_of(journal));
    return true;
  }
  if (!removed) {
    facts.orphan_kept(journal, removed.error().message);
    return false;
  }
  if (*removed) {
    facts.orphan_empty(journal);
    return true;
  }
  const base::Result<std::filesystem::path> file = finalise(journal);
  if (file) {
    facts.orphan_finalised(*file);
  } else {
    facts.orphan_kept(journal, file.error().message);
  }
  return file.has_value();
}

bool recover_folder(const std::filesystem::path& folder, const Finalise& finalise, Facts& facts) {
  bool all = true;
  for (const std::filesystem::path& journal : journals_in(folder))
    all = recover_journal(journal, finalise, facts) && all;
  return all;
}

}  // namespace stickslip::daemon
