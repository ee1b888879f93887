/// \file
/// An append-only file of text lines. Several programs may append to it (flock); readers see complete lines
/// only.
///
///     LineJournal journal{folder / "batches.jsonl"};
///     journal.append({line});
///     journal.read_on([](std::string_view line, std::int64_t number) { … });
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/file_calls.hpp"

namespace stickslip::daemon {

class LineJournal {
 public:
  /// \param calls  outlive it.
  explicit LineJournal(std::filesystem::path path, const record::FileCalls& calls = record::system_calls())
      : path_(std::move(path)), calls_(calls) {}

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  /// Appends lines, given without line feeds; blocks until they are on the disk. An incomplete last line,
  /// left by a power cut or a full disk, is ended first. Errors: kFailure; the first lines may be written
  /// then.
  [[nodiscard]] base::Result<void> append(const std::vector<std::string>& lines) const;

  /// Calls `line` with each complete line appended since the last call that is not empty, and its number from
  /// 1. A missing file counts as empty. Errors: kFailure if the file cannot be read or has become shorter.
  [[nodiscard]] base::Result<void> read_on(const std::function<void(std::string_view, std::int64_t)>& line);

 private:
  std::filesystem::path path_;
  const record::FileCalls& calls_;
  std::uintmax_t read_ = 0;  ///< Bytes read so far, up to the end of a line.
  std::int64_t line_ = 0;    ///< Lines read so far.
};

}  // namespace stickslip::daemon
