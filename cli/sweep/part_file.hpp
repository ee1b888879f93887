/// \file
/// The finished runs of a sweep that is still under way, so that it can be stopped at any moment and
/// go on later: JSON lines, appended. The first says which sweep it is, each other one is a run.
///
///     Result<PartFile> part = PartFile::open("sweep.h5.part", facts, clock);
///     part->missing();          // which runs are still to be done
///     part->append(run);
///     part->table();            // of all runs
///     part->remove();
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "core/base/clock.hpp"
#include "core/base/result.hpp"
#include "core/record/file.hpp"
#include "core/record/sweep.hpp"

namespace stickslip::sweep {

/// Thread-bound.
class PartFile {
 public:
  /// Opens what is there or makes it. Lines that are not whole, and all after them, are dropped: those runs
  /// are done again. \param facts  also stand for the sweep in the result. \param clock  outlives it; tells
  /// when a second is over and nothing else.
  /// Errors: kUsage if the file is something else, of another sweep (says what differs), or written by
  /// another program right now; else kFailure.
  [[nodiscard]] static base::Result<PartFile> open(const std::filesystem::path& path,
                                                   const record::SweepFacts& facts, const base::Clock& clock);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::int64_t done_count() const noexcept { return done_count_; }
  /// Numbers of the runs that are not in the file, rising.
  [[nodiscard]] std::vector<std::int64_t> missing() const;

  /// Written at once, on the disk within about a second, or with the next run.
  [[nodiscard]] base::Result<void> append(const record::SweepRun& run);
  /// All runs so far onto the disk.
  [[nodiscard]] base::Result<void> sync();

  /// The runs of the file.
  [[nodiscard]] base::Result<record::SweepTable> table() const;

  [[nodiscard]] base::Result<void> remove();

 private:
  PartFile(std::filesystem::path path, record::Descriptor file, const record::SweepFacts& facts,
           const base::Clock& clock);

  /// What the file holds, up to the first line that is not whole.
  [[nodiscard]] base::Result<void> take_over(const record::SweepFacts& facts);
  [[nodiscard]] base::Result<void> write(const std::string& line);

  std::filesystem::path path_;
  record::Descriptor file_;
  std::vector<bool> done_;
  std::int64_t done_count_ = 0;
  const base::Clock* clock_;
  std::int64_t synced_ns_;
};

}  // namespace stickslip::sweep
