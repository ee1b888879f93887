/// \file
/// The part file: finished runs of an unfinished sweep, so that a stopped sweep can be resumed. It has lines
/// of JSON: first the identity of the sweep, then one line for each run.
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
  /// Opens or creates the file. Runs from the first invalid line on are dropped and must be repeated. \param
  /// facts  identify the sweep. \param clock  outlives this object; it only times the syncs. Errors: kUsage
  /// if the file is no part file, belongs to another sweep (the message says what differs) or is in use by
  /// another program; else kFailure.
  [[nodiscard]] static base::Result<PartFile> open(const std::filesystem::path& path,
                                                   const record::SweepFacts& facts, const base::Clock& clock);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::int64_t done_count() const noexcept { return done_count_; }
  /// Numbers of the runs that are not in the file, ascending.
  [[nodiscard]] std::vector<std::int64_t> missing() const;

  /// Writes a run at once; syncs the file if the last sync is a second old. Errors: kFailure.
  [[nodiscard]] base::Result<void> append(const record::SweepRun& run);
  /// Blocks until all runs so far are on the disk.
  [[nodiscard]] base::Result<void> sync();

  /// Reads the runs of the file as a table.
  [[nodiscard]] base::Result<record::SweepTable> table() const;

  [[nodiscard]] base::Result<void> remove();

 private:
  PartFile(std::filesystem::path path, record::Descriptor file, const record::SweepFacts& facts,
           const base::Clock& clock);

  /// Reads the file up to the first invalid line.
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
