/// \file
/// The parts of the file that `stickslip bundle` writes. None fails: a part that cannot be had says why.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/redaction.hpp"

namespace stickslip::cli::bundle {

/// What a configuration names; defaults for what cannot be read of it. Relative paths are of the working
/// directory.
struct Named {
  std::string unread{};  ///< Why the configuration is no TOML; empty if it is.
  std::filesystem::path record_folder{};
  std::filesystem::path socket{};
  std::filesystem::path method{};  ///< Empty: none, as the next two.
  std::filesystem::path characterisation{};
  std::filesystem::path calibration{};                ///< A file or a folder.
  std::vector<std::filesystem::path> secret_files{};  ///< Never read.
};

/// \param file  the configuration, which may be missing or wrong.
[[nodiscard]] Named named_in(const std::filesystem::path& file);

[[nodiscard]] std::string configuration_text(const std::filesystem::path& file, const Redaction& redaction);
/// Method, characterisation and latest calibration.
[[nodiscard]] std::string named_files_text(const Named& named, const Redaction& redaction);
/// Kernel, distribution, state of the service, file system of the records.
[[nodiscard]] std::string system_text(const Named& named);
[[nodiscard]] std::string status_text(const Named& named, const Redaction& redaction);
/// The last lines of the log. \param file  the log; empty: the journal.
[[nodiscard]] std::string log_text(const std::filesystem::path& file);
/// How many files of each kind, and the names of those that tell of trouble.
[[nodiscard]] std::string folder_text(const Named& named);
/// Facts and results of the daemon's last records.
[[nodiscard]] std::string records_text(const Named& named, int most, const Redaction& redaction);

}  // namespace stickslip::cli::bundle
