/// \file
/// A file that holds columns of numbers instead of text: of MATLAB, or HDF5. It is read in a child process
/// within limits.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/traces/column_name.hpp"
#include "io/traces/text_file.hpp"

#include "core/base/limited_child.hpp"
#include "core/base/result.hpp"
#include "core/record/number_column.hpp"

namespace stickslip::traces {

struct TraceTable;

/// Thread-bound.
class NumberFile {
 public:
  /// \return null for any other file. To be called while this process has one thread. Errors: kUsage for a
  /// file that is damaged, that breaks a limit, that has no column, and for a record of stickslip; kFailure
  /// if it cannot be read.
  [[nodiscard]] static base::Result<std::unique_ptr<NumberFile>> open(const Source& source);

  /// "MATLAB 5", "HDF5".
  [[nodiscard]] const std::string& format() const noexcept { return format_; }
  /// As the format calls it: "variable F", "dataset /run1/force".
  [[nodiscard]] std::string called(std::size_t column) const;
  /// Option of `stickslip import` that names a column: "--column", of HDF5 "--dataset".
  [[nodiscard]] const char* option() const noexcept { return is_hdf5_ ? "--dataset" : "--column"; }
  /// "/run1/table(:,2)".
  [[nodiscard]] std::string name(std::size_t column) const;
  /// The same in parts; the name is that behind the last point or slash.
  [[nodiscard]] ColumnName column_name(std::size_t column) const;
  [[nodiscard]] std::size_t count() const noexcept { return columns_.size(); }
  [[nodiscard]] std::size_t size(std::size_t column) const { return columns_[column].size; }

  /// How near a column stands to another one of its size: deeper groups that hold both are nearer. Nothing
  /// if the sizes differ, or if it stands in a group without the other one.
  [[nodiscard]] std::optional<int> nearness(std::size_t column, std::size_t other) const;

  /// What is in the file and is no column, "z is complex", at most 20; empty for nothing.
  [[nodiscard]] std::string refused() const;
  /// "/run1/force (2800): /short (5), /long (9999)": columns that cannot be read together with this one, at
  /// most 20; empty for none.
  [[nodiscard]] std::string of_other_size(std::size_t column) const;
  /// kUsage: what is wrong with this name, and the names that there are.
  [[nodiscard]] base::Error no_column(const std::string& wanted) const;
  /// The names with their numbers, at most 20.
  [[nodiscard]] std::string listed() const;

  /// As read_table().
  [[nodiscard]] base::Result<TraceTable> table(std::size_t value_column,
                                               std::optional<std::size_t> time_column,
                                               const std::filesystem::path& scratch_folder);

 private:
  NumberFile(const Source& source, bool is_hdf5);
  [[nodiscard]] base::Result<void> list();
  [[nodiscard]] base::Result<std::string> ask(const std::string& question);
  [[nodiscard]] base::Result<std::vector<double>> read(std::size_t column);

  std::string path_;
  std::string format_;
  bool is_hdf5_;
  std::uint64_t file_size_ = 0;
  std::string sha256_;
  base::LimitedChild child_;
  std::vector<record::NumberColumn> columns_;
  std::vector<std::size_t> places_;  ///< Of them, among all that the child lists.
  std::vector<record::NumberColumn> refused_;
};

}  // namespace stickslip::traces
