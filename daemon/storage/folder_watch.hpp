/// \file
/// Detects that the file system of the record folder was unmounted. The path then leads to a folder on the
/// file system below, and files written there would be hidden after the next mount.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/record/file_calls.hpp"

namespace stickslip::storage {

class FolderWatch {
 public:
  /// Remembers the file system that the folder is on now; of a missing folder, that of its nearest existing
  /// parent. \param calls  outlive this object.
  FolderWatch(std::filesystem::path folder, const record::FileCalls& calls);

  struct Away {
    std::string why;
    std::string to_do;
  };
  /// Why the folder must not be written to now; nothing if it may. It may be written to, and made if missing,
  /// on its own file system, and on a new one that was mounted in its place.
  [[nodiscard]] std::optional<Away> look();

 private:
  /// Device numbers of the folder and of its parents, without repetitions in a row. Empty, with errno set, if
  /// they cannot be read.
  [[nodiscard]] std::vector<dev_t> devices() const;

  std::filesystem::path folder_;
  const record::FileCalls& calls_;
  std::vector<dev_t> devices_;  ///< The expected ones.
};

}  // namespace stickslip::storage
