/// \file
/// Whether the folder of the records is where it was: a folder below a mount point whose file system went
/// away is another one, and what is written there is hidden when the file system comes back.
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
  /// Takes the file system that the folder, or the nearest folder above it that is there, is on now for the
  /// one that it belongs to. \param calls  outlive this object.
  FolderWatch(std::filesystem::path folder, const record::FileCalls& calls);

  struct Away {
    std::string why;
    std::string to_do;
  };
  /// Why nothing may be written in the folder now. A folder that is missing on its own file system may be
  /// made again; so may one on a file system that was mounted in its place since.
  [[nodiscard]] std::optional<Away> look();

 private:
  /// Devices of the folder and, each once in a row, of those above it. Empty with errno where none can be
  /// had.
  [[nodiscard]] std::vector<dev_t> devices() const;

  std::filesystem::path folder_;
  const record::FileCalls& calls_;
  std::vector<dev_t> devices_;  ///< As they are meant to be.
};

}  // namespace stickslip::storage
