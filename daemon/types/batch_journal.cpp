#include "daemon/types/batch_journal.hpp"

#include <fmt/format.h>

#include "daemon/types/batch_json.hpp"

namespace stickslip::daemon {
namespace {

/// Folders between a record and its journal, at most: 2026/11/20261121T125252Z-0003.h5.
constexpr int kDatedLevels = 2;

}  // namespace

BatchJournal::BatchJournal(const std::filesystem::path& folder, const record::FileCalls& calls)
    : lines_(folder / kBatchJournal, calls) {}

base::Result<void> BatchJournal::append(const BatchEvent& event) const {
  return lines_.append({line_of(event)});
}

base::Result<std::vector<std::string>> BatchJournal::read_on(BatchBook& book) {
  std::vector<std::string> remarks;
  const auto read = lines_.read_on([&](std::string_view line, std::int64_t number) {
    const base::Result<BatchEvent> event = event_of(line);
    if (event) {
      book.apply(*event);
    } else {
      remarks.push_back(fmt::format("{}: line {}: {}", path().string(), number, event.error().message));
    }
  });
  if (!read) return tl::unexpected(read.error());
  return remarks;
}

std::optional<std::filesystem::path> journal_folder_of(const std::filesystem::path& record) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(record, error);
  return error ? std::nullopt : journal_folder_above(whole.parent_path());
}

std::optional<std::filesystem::path> journal_folder_above(std::filesystem::path folder) {
  std::error_code error;
  for (int level = 0; level <= kDatedLevels; ++level) {
    if (std::filesystem::exists(folder / kBatchJournal, error)) return folder;
    if (folder == folder.root_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

std::string name_in_journal(const std::filesystem::path& folder, const std::filesystem::path& record) {
  std::error_code error;
  const auto whole = std::filesystem::weakly_canonical(record, error);
  const auto base = std::filesystem::weakly_canonical(folder, error);
  return whole.lexically_relative(base).generic_string();
}

}  // namespace stickslip::daemon
