/// \file
/// Durable files: every result checked, errors with the path and the system's words.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/descriptor.hpp"
#include "core/base/result.hpp"
#include "core/base/wording.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::record {

using base::Descriptor;
using base::system_message;

/// fsync of a file by its path.
[[nodiscard]] base::Result<void> sync_path(const std::filesystem::path& path,
                                           const FileCalls& calls = system_calls());

/// fsync of a folder: names in it survive a power cut. A file system that cannot sync folders (EINVAL and the
/// like) is none that refuses: that this may lose a name is told once, by probe_folder().
[[nodiscard]] base::Result<void> sync_folder(const std::filesystem::path& folder,
                                             const FileCalls& calls = system_calls());

/// Whether a call failed because the file system does not know it.
[[nodiscard]] bool is_unsupported(int error) noexcept;

/// The folder that holds a file, "." for a bare name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& path);

/// Renames without ever replacing; kUsage if `to` exists. The folder is synced. Where the file system cannot
/// rename so, the file gets its new name as a second one and loses the first; where there are no second names
/// either, the new name is taken by an empty file, which is then replaced: a stop between leaves it.
[[nodiscard]] base::Result<void> rename_to_new(const std::filesystem::path& from,
                                               const std::filesystem::path& to,
                                               const FileCalls& calls = system_calls());

/// Makes the folders that are missing and their names durable. Errors: kFailure.
[[nodiscard]] base::Result<void> make_folders(const std::filesystem::path& folder,
                                              const FileCalls& calls = system_calls());

/// write() until all is written or an error. \return bytes written; errno says why if fewer.
[[nodiscard]] std::size_t write_all(int descriptor, std::span<const std::byte> bytes, const FileCalls& calls);

/// The whole file. Errors as base::read_text().
[[nodiscard]] base::Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

}  // namespace stickslip::record
