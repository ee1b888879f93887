/// \file
/// The journal of batches: an append-only file beside the records, one line of JSON for each event. Several
/// programs may append to it (flock); readers see complete lines only.
///
///     BatchJournal journal{folder};
///     journal.append({at, "ada", TestVoided{"20261121T125252Z-0003.h5", "paper torn"}});
///     journal.read_on(book);
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "daemon/types/batch.hpp"
#include "daemon/types/line_journal.hpp"

namespace stickslip::daemon {

inline constexpr const char* kBatchJournal = "batches.jsonl";

class BatchJournal {
 public:
  /// \param folder  of the records. \param calls  outlive it.
  explicit BatchJournal(const std::filesystem::path& folder,
                        const record::FileCalls& calls = record::system_calls());

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return lines_.path(); }

  /// Appends a line; blocks until it is on the disk. An incomplete last line, left by a power cut or a full
  /// disk, is ended first. Errors: kFailure.
  [[nodiscard]] base::Result<void> append(const BatchEvent& event) const;

  /// Applies the events appended since the last call. \return a remark for each line that cannot be
  /// understood: its place and why. A missing file counts as empty. Errors: kFailure if the file cannot be
  /// read or has become shorter.
  [[nodiscard]] base::Result<std::vector<std::string>> read_on(BatchBook& book);

 private:
  LineJournal lines_;
};

/// The folder of the journal for a record: the record's folder or one of the two above it (dated folders).
/// Nothing if none of them holds a journal.
[[nodiscard]] std::optional<std::filesystem::path> journal_folder_of(const std::filesystem::path& record);
/// The same. \param folder  of the record, canonical.
[[nodiscard]] std::optional<std::filesystem::path> journal_folder_above(std::filesystem::path folder);

/// The name of a record in the journal of `folder`: its path relative to the folder.
[[nodiscard]] std::string name_in_journal(const std::filesystem::path& folder,
                                          const std::filesystem::path& record);

}  // namespace stickslip::daemon
