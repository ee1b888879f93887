/// \file
/// Durable file operations. Errors contain the path and, where a system call failed, its message.
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

/// fsync of a file by its path. Errors: kFailure.
[[nodiscard]] base::Result<void> sync_path(const std::filesystem::path& path,
                                           const FileCalls& calls = system_calls());

/// fsync of a folder, so that names in it survive a power cut. Succeeds on a file system that cannot sync
/// folders (EINVAL and the like); probe_folder() reports that limitation. Errors: kFailure.
[[nodiscard]] base::Result<void> sync_folder(const std::filesystem::path& folder,
                                             const FileCalls& calls = system_calls());

/// Whether this errno value means that the file system does not support the call.
[[nodiscard]] bool is_unsupported(int error) noexcept;

/// The folder that holds a file, "." for a bare name.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& path);

/// Renames without ever replacing, and syncs the folder of `to`. Errors: kUsage if `to` exists, else
/// kFailure; if only the sync failed, the file has its new name. Without RENAME_NOREPLACE, it links the new
/// name and removes the old one; if only the removal fails, the file keeps both names, without an error.
/// Without hard links, it creates an empty file under the new name and renames over it; a stop in between
/// leaves the empty file.
[[nodiscard]] base::Result<void> rename_to_new(const std::filesystem::path& from,
                                               const std::filesystem::path& to,
                                               const FileCalls& calls = system_calls());

/// Creates the missing folders of a path and syncs their names; nothing for an empty path. Errors: kFailure.
[[nodiscard]] base::Result<void> make_folders(const std::filesystem::path& folder,
                                              const FileCalls& calls = system_calls());

/// write() until all is written or an error. \return bytes written; errno says why if fewer.
[[nodiscard]] std::size_t write_all(int descriptor, std::span<const std::byte> bytes, const FileCalls& calls);

/// Content of a whole file. Errors as base::read_text().
[[nodiscard]] base::Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

}  // namespace stickslip::record
