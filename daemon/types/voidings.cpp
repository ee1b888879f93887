#include "daemon/types/voidings.hpp"

namespace stickslip::daemon {

base::Result<std::optional<Voiding>> Voidings::of(const std::filesystem::path& record) {
  const std::optional<std::filesystem::path> folder = journal_folder_of(record);
  if (!folder) return std::optional<Voiding>{};
  const auto [book, is_new] = books_.try_emplace(*folder);
  if (is_new) {
    if (const auto read = BatchJournal{*folder}.read_on(book->second); !read) {
      books_.erase(book);
      return tl::unexpected(read.error());
    }
  }
  const Voiding* const voided = book->second.voided(name_in_journal(*folder, record));
  return voided == nullptr ? std::optional<Voiding>{} : *voided;
}

}  // namespace stickslip::daemon
