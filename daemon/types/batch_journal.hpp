/// \file
/// The journal of batches: one line of JSON for each event, in a file beside the records that is only ever
/// appended to. Several programs may append; whoever reads sees the lines that are whole.
///
///     BatchJournal journal{folder};
///     journal.append({at, "ada", TestVoided{"20261121T125252Z-0003.h5", "paper torn"}});
///     journal.read_on(book);
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "daemon/types/batch.hpp"

namespace stickslip::daemon {

inline constexpr const char* kBatchJournal = "batches.jsonl";

class BatchJournal {
 public:
  /// \param folder  of the records. \param calls  outlive it.
  explicit BatchJournal(const std::filesystem::path& folder,
                        const record::FileCalls& calls = record::system_calls());

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  /// Durable when it returns. A line that a power cut or a full disk left in the middle is closed first, so
  /// that it spoils no other. Errors: kFailure.
  [[nodiscard]] base::Result<void> append(const BatchEvent& event) const;

  /// Applies what was appended since the last call. \return a remark for each line that means nothing: where
  /// it is and why. Errors: kFailure. No file is an empty one.
  [[nodiscard]] base::Result<std::vector<std::string>> read_on(BatchBook& book);

 private:
  std::filesystem::path path_;
  const record::FileCalls& calls_;
  std::uintmax_t read_ = 0;  ///< Bytes, up to the end of a line.
  std::int64_t line_ = 0;    ///< Lines, so far.
};

/// The folder of the journal that tells of a record: its own or one of the two above it (dated folders). None
/// if there is no journal.
[[nodiscard]] std::optional<std::filesystem::path> journal_folder_of(const std::filesystem::path& record);

/// A record by the name it has in the journal of that folder.
[[nodiscard]] std::string name_in_journal(const std::filesystem::path& folder,
                                          const std::filesystem::path& record);

}  // namespace stickslip::daemon
