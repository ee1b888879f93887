#include "daemon/types/voidings.hpp"

namespace stickslip::daemon {

base::Result<std::optional<Voiding>> Voidings::of(const std::filesystem::path& record) {
  std::error_code gone;  // A void record may have been moved away.
  std::error_code error;
  // A link may lead to another folder; else many records have one.
  const std::filesystem::path whole = std::filesystem::is_symlink(record, gone)
                                          ? std::filesystem::weakly_canonical(record, error)
                                          : canonical(record.parent_path()) / record.filename();
  if (error || !whole.has_parent_path()) return std::optional<Voiding>{};  // It cannot be looked at.
  const auto [found, is_new_folder] = journals_.try_emplace(whole.parent_path());
  if (is_new_folder) found->second = journal_folder_above(whole.parent_path());
  const std::optional<std::filesystem::path>& folder = found->second;
  if (!folder) return std::optional<Voiding>{};
  const auto [book, is_new] = books_.try_emplace(*folder);
  if (is_new) {
    if (const auto read = BatchJournal{*folder}.read_on(book->second); !read) {
      books_.erase(book);
      return tl::unexpected(read.error());
    }
  }
  const Voiding* const voided = book->second.voided(whole.lexically_relative(*folder).generic_string());
  return voided == nullptr ? std::optional<Voiding>{} : *voided;
}

const std::filesystem::path& Voidings::canonical(const std::filesystem::path& folder) {
  const auto [found, is_new] = canonical_.try_emplace(folder);
  if (is_new) {
    std::error_code error;
    found->second = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, error);
  }
  return found->second;
}

}  // namespace stickslip::daemon
