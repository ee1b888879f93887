/// \file
/// From a journal to the finished file: built whole beside it, verified, published by one rename.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// Evaluates a test whose journal has no end: the analysis lives above this folder.
using Evaluate = std::function<EndRecord(const Record&)>;

/// Builds TEST.h5 from TEST.journal and then removes the journal, in the memory of the tables however many
/// scans there are (a journal without an end that is to be evaluated excepted). On any error nothing but the
/// journal is left. A file that stands there already is never written again: if it holds the same
/// scans the journal is removed, if not it is an error.
///
/// Meant for a process of its own: HDF5 has one global lock and its errors can be fatal. Starts no
/// threads.
/// \param evaluate  asked if the journal has no end; without it such a test gets no results, with
///                  the reason "interrupted". Its status is "interrupted" either way.
/// \param longest  to wait for somebody else who finishes the journal.
/// \return the finished file. Errors: kUsage if the file is no journal, else kFailure.
[[nodiscard]] base::Result<std::filesystem::path> finalise(const std::filesystem::path& journal,
                                                           const Evaluate& evaluate = {},
                                                           const FileCalls& calls = system_calls(),
                                                           std::chrono::milliseconds longest = {});

/// Whether a record can be made at `path`: nothing stands there (kUsage), its folder does (kUsage).
[[nodiscard]] base::Result<void> check_publishable(const std::filesystem::path& path);

/// Writes a whole record at `path`, which must not exist (kUsage): built as PATH.part, compared
/// with `record` scan for scan, made durable, renamed. On any error no file is left.
/// \param record  has an end.
[[nodiscard]] base::Result<void> publish_record(const Record& record, const std::filesystem::path& path);

/// As publish_record(), but the scans come piece by piece from the journal, which stays where it is.
/// \param record  all but the scans.
[[nodiscard]] base::Result<void> publish_journal(const std::filesystem::path& journal, const Record& record,
                                                 const std::filesystem::path& path);

}  // namespace stickslip::record
