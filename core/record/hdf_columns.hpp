/// \file
/// Columns of numbers in any HDF5 file.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/number_column.hpp"

namespace stickslip::record {

/// An open HDF5 file of any program, with its columns of numbers. Use it in a child process with limits
/// (base::LimitedChild): HDF5 may crash or hang on a damaged or malicious file. Thread-bound, movable.
class HdfColumns {
 public:
  /// Opens the file and lists its columns. Errors, without the file's name: kUsage if it is damaged or no
  /// HDF5 file; else as open_shared().
  [[nodiscard]] static base::Result<HdfColumns> open(const std::filesystem::path& path);

  HdfColumns(HdfColumns&&) noexcept;
  HdfColumns& operator=(HdfColumns&&) noexcept;
  ~HdfColumns();

  /// Whether the file is a record of this program, of any version.
  [[nodiscard]] bool is_record() const;
  /// Columns of the first 10 000 datasets, by name: one for each vector, each numeric member of a compound,
  /// and each row or column of a matrix along its longer axis. What cannot be read is in the list too, with
  /// the reason in NumberColumn::why: text, for example, or a dataset stored in another file.
  [[nodiscard]] const std::vector<NumberColumn>& columns() const noexcept;

  /// Values of a column of columns() that has no NumberColumn::why. Integers become the nearest double.
  /// Errors: kUsage if it cannot be read, without the file's name.
  [[nodiscard]] base::Result<std::vector<double>> read(const NumberColumn& column) const;

 private:
  struct Opened;
  explicit HdfColumns(std::unique_ptr<Opened> opened);
  std::unique_ptr<Opened> opened_;
};

}  // namespace stickslip::record
