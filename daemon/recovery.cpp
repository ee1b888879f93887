#include "daemon/recovery.hpp"

#include "core/record/journal_care.hpp"
#include "daemon/finaliser.hpp"

namespace stickslip::daemon {
bool recover_journal(const std::filesystem::path& journal, const Finalise& finalise, Facts& facts) {
  const base::Result<bool> removed = record::remove_if_empty(journal, kOthersTime);
  if (!removed && is_finished(journal)) {
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
