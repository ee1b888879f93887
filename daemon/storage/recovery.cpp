#include "daemon/storage/recovery.hpp"

#include <algorithm>
#include <string>

#include "core/record/journal_care.hpp"
#include "daemon/storage/finaliser_process.hpp"

namespace stickslip::storage {

Recovery recover_journal(const std::filesystem::path& journal, const Finalise& finalise,
                         daemon::Facts& facts) {
  const base::Result<bool> removed = record::remove_if_empty(journal, kOthersTime);
  if (!removed && is_finished(journal)) {
    facts.orphan_finalised(record_of(journal));
    return Recovery::kDone;
  }
  if (!removed) {
    facts.orphan_kept(journal, removed.error().message);
    return Recovery::kRefused;
  }
  if (*removed) {
    facts.orphan_empty(journal);
    return Recovery::kDone;
  }
  const base::Result<record::Finalised> made = finalise(journal, {});
  if (!made) {
    facts.orphan_kept(journal, made.error().message);
    return Recovery::kRefused;
  }
  facts.orphan_finalised(made->file);
  const std::string loss = loss_of(*made);
  if (loss.empty()) return Recovery::kDone;
  facts.record_damaged(made->file, loss);
  return Recovery::kDamaged;
}

Recovery recover_folder(const std::filesystem::path& folder, const Finalise& finalise, daemon::Facts& facts) {
  Recovery worst = Recovery::kDone;
  const io::FilesFound journals = journals_in(folder);
  for (const std::filesystem::path& journal : journals.files)
    worst = std::max(worst, recover_journal(journal, finalise, facts));
  for (const auto& [unread, why] : journals.unread) {
    facts.folder_unread(unread, why);
    worst = Recovery::kRefused;
  }
  return worst;
}

}  // namespace stickslip::storage
