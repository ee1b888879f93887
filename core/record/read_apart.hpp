/// \file
/// Records that somebody gives are read in a child process within limits: HDF5 may not come back from a file
/// that is damaged or made to deceive. Programs say so once; until then, and in tests, they are read here.
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

/// Of this program as such a child.
inline constexpr std::string_view kReaderOption = "--read-files";
inline constexpr std::string_view kResultsReaderOption = "--read-results";  ///< Names of results follow.
inline constexpr std::string_view kFactsReaderOption = "--read-facts";

/// A child that reads one record after the other. Thread-bound.
class ApartReader {
 public:
  /// \param child  works with read_for_parent().
  explicit ApartReader(base::LimitedChild child) : child_(std::move(child)) {}

  /// The same record as that of read_record(), to the last bit; strings that are no UTF-8 are made it.
  /// Errors as read_record(); kUsage if reading breaks a limit or kills the child; kInterrupted if it is
  /// given up.
  [[nodiscard]] base::Result<Record> read(const std::filesystem::path& path, const base::WorkLimits& limits,
                                          const std::function<bool()>& given_up = {});

  /// The two halves of read(): this process can do other work between them.
  [[nodiscard]] base::Result<void> begin(const std::filesystem::path& path, const base::WorkLimits& limits);
  [[nodiscard]] base::Result<Record> finish(const std::function<bool()>& given_up = {});

 private:
  base::LimitedChild child_;
  std::filesystem::path path_;  ///< Of the record that was begun.
};

/// A ChildWork: reads the record of that path into the memory file, as a journal.
[[nodiscard]] std::string read_for_parent(std::string_view path, int memory_file);
/// The same with read_without_scans().
[[nodiscard]] std::string read_results_for_parent(std::string_view path, std::span<const std::string> only,
                                                  int memory_file);
/// The same with read_facts().
[[nodiscard]] std::string read_facts_for_parent(std::string_view path, int memory_file);

/// Never returns in a process that was started as a reader.
void serve_if_reader(int count, char** arguments);

/// From now on read_record_apart() uses children, two at most for each thread: this program, started again.
/// To be called before there are threads. \param given_up  as LimitedChild::ask().
void read_records_apart(std::function<bool()> given_up = {});

/// Of a file that somebody gives. Errors as ApartReader::read().
/// \param next  files that will be asked for next, in their order: the children read the first two while this
/// process works on `path`.
[[nodiscard]] base::Result<Record> read_record_apart(const std::string& path,
                                                     std::span<const std::string> next = {});

/// files[index], for those who read one after the other. Errors as read_record_apart().
[[nodiscard]] base::Result<Record> read_record_in_turn(std::span<const std::string> files, std::size_t index);

/// As read_record_apart(), with read_without_scans().
[[nodiscard]] base::Result<Record> read_results_apart(const std::string& path,
                                                      std::span<const std::string> only = {},
                                                      std::span<const std::string> next = {});

/// As read_record_apart(), with read_facts().
[[nodiscard]] base::Result<Record> read_facts_apart(const std::string& path,
                                                    std::span<const std::string> next = {});

}  // namespace stickslip::record
