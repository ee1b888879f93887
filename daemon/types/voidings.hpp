/// \file
/// Which records are void, by the batch journals beside them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>

#include "core/base/result.hpp"
#include "daemon/types/batch_journal.hpp"

namespace stickslip::daemon {

/// Reads each journal once.
class Voidings {
 public:
  /// \param record  its path. \return nullopt if it is not void. Errors: kFailure if its journal cannot be
  /// read.
  [[nodiscard]] base::Result<std::optional<Voiding>> of(const std::filesystem::path& record);

 private:
  const std::filesystem::path& canonical(const std::filesystem::path& folder);

  std::map<std::filesystem::path, std::filesystem::path> canonical_;                ///< By folder as given.
  std::map<std::filesystem::path, std::optional<std::filesystem::path>> journals_;  ///< By canonical folder.
  std::map<std::filesystem::path, BatchBook> books_;  ///< By the folders of the journals.
};

}  // namespace stickslip::daemon
