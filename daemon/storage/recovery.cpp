#include "daemon/storage/recovery.hpp"

#include <algorithm>
#include <string>

#include "core/record/journal_care.hpp"
#include "daemon/storage/finaliser_process.hpp"

namespace stickslip::storage {

Recovery recover_journal(const std::filesystem::path& journal, const Finalise& finalise,
                         daemon::EventReceiver& events) {
  const base::Result<bool> removed = record::remove_if_empty(journal, kOthersTime);
  if (!removed && is_finished(journal)) {
    events.orphan_finalised(record_of(journal));
    return Recovery::kDone;
  }
  if (!removed) {
    events.orphan_kept(journal, removed.error().message);
    return Recovery::kRefused;
  }
  if (*removed) {
    events.orphan_empty(journal);
    return Recovery::kDone;
  }
  const base::Result<record::Finalised> made = finalise(journal, {});
  if (!made) {
    events.orphan_kept(journal, made.error().message);
    return Recovery::kRefused;
  }
  events.orphan_finalised(made->file);
  const std::string loss = loss_of(*made);
  if (loss.empty()) return Recovery::kDone;
  events.record_damaged(made->file, loss);
  return Recovery::kDamaged;
}

Recovery recover_folder(const std::filesystem::path& folder, const Finalise& finalise,
                        daemon::EventReceiver& events) {
  Recovery worst = Recovery::kDone;
  const io::FilesFound journals = journals_in(folder);
  for (const std::string& journal : journals.files)
    worst = std::max(worst, recover_journal(journal, finalise, events));
  for (const auto& [unread, why] : journals.unread) {
    events.folder_unread(unread, why);
    worst = Recovery::kRefused;
  }
  return worst;
}

}  // namespace stickslip::storage
