/// \file
/// Reads records in a child process, within limits of time and memory: HDF5 may crash or never return on a
/// damaged or malicious file. read_record_apart(), read_results_apart() and read_facts_apart() use children
/// once the program has called read_records_apart(); before, they read in this process.
///
///     int main(int count, char** arguments) {
///       serve_if_reader(count, arguments);
///       read_records_apart();
///       … read_record_apart(path) …
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/limited_child.hpp"
#include "core/base/result.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

// First argument of this program when it is started as such a child.

inline constexpr std::string_view kReaderOption = "--read-files";
inline constexpr std::string_view kResultsReaderOption = "--read-results";  ///< Names of results may follow.
inline constexpr std::string_view kFactsReaderOption = "--read-facts";

/// A child process that reads one record after the other. Thread-bound.
class ApartReader {
 public:
  /// \param child  its work is read_for_parent(), read_results_for_parent() or read_facts_for_parent().
  explicit ApartReader(base::LimitedChild child) : child_(std::move(child)) {}

  /// Reads a record. Its numbers are to the last bit those of the function that the child's work calls, such
  /// as read_record(). Three things differ: bytes of texts that are no UTF-8 are replaced; scans missing
  /// without a gap become gaps with the cause unknown; gaps and clock anchors are sorted by scan. Errors as
  /// that function, and: kUsage if reading exceeds a limit or kills the child; kInterrupted if given_up() was
  /// true; kFailure if no child can be started or its answer makes no sense.
  /// \param given_up  called ten times a second and at each signal; true gives up. Empty: never.
  [[nodiscard]] base::Result<Record> read(const std::filesystem::path& path, const base::WorkLimits& limits,
                                          const std::function<bool()>& given_up = {});

  /// The two halves of read(), to do other work between them. A second begin() without finish() discards the
  /// first record. finish() needs a begin() before it that succeeded (contract). Errors of begin(): kFailure
  /// if no child can be started; of finish(): those of read().
  [[nodiscard]] base::Result<void> begin(const std::filesystem::path& path, const base::WorkLimits& limits);
  [[nodiscard]] base::Result<Record> finish(const std::function<bool()>& given_up = {});

 private:
  base::LimitedChild child_;
  std::filesystem::path path_;  ///< Of the record that was begun.
};

// Work of a child (base::ChildWork): each reads the record at `path` and writes it as a journal into the
// memory file. \return the answer that ApartReader::finish() understands: the checksum of the raw values, or
// the error. \throws std::runtime_error if the memory file has no room.

/// Reads by read_record().
[[nodiscard]] std::string read_for_parent(std::string_view path, int memory_file);
/// Reads by read_without_scans(). \param only  names of the results to read; empty: all.
[[nodiscard]] std::string read_results_for_parent(std::string_view path, std::span<const std::string> only,
                                                  int memory_file);
/// Reads by read_facts().
[[nodiscard]] std::string read_facts_for_parent(std::string_view path, int memory_file);

/// Serves as a reader, and never returns, if the first argument is one of the three options and standard
/// input is a socket. Otherwise returns at once; also if arguments follow an option other than
/// kResultsReaderOption.
void serve_if_reader(int count, char** arguments);

/// From now on the functions below use children: this program, started again. Each thread has at most two for
/// each of the functions, and for each list `only`. To be called before there are threads.
/// \param given_up  called by the thread that reads, ten times a second and at each signal; true gives up the
///        record. Empty: never.
void read_records_apart(std::function<bool()> given_up = {});

/// Reads a record from a file that the user gives: by ApartReader::read() within base::limits_for_file(), or,
/// before read_records_apart(), by read_record(). Errors as there; kUsage if it is no regular file.
/// \param next  files that will be asked for next, in their order: children read the first two of them while
///        this process works on the record at `path`.
[[nodiscard]] base::Result<Record> read_record_apart(const std::string& path,
                                                     std::span<const std::string> next = {});

/// read_record_apart() of files[index] with the files after it as `next`, for a loop over all files.
/// \param index  < files.size().
[[nodiscard]] base::Result<Record> read_record_in_turn(std::span<const std::string> files, std::size_t index);

/// As read_record_apart(), but reads only what read_without_scans() does.
/// \param only  names of the results to read; empty: all.
[[nodiscard]] base::Result<Record> read_results_apart(const std::string& path,
                                                      std::span<const std::string> only = {},
                                                      std::span<const std::string> next = {});

/// As read_record_apart(), but reads only what read_facts() does.
[[nodiscard]] base::Result<Record> read_facts_apart(const std::string& path,
                                                    std::span<const std::string> next = {});

}  // namespace stickslip::record
