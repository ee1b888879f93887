/// \file
/// Columns of numbers in an HDF5 file that another program wrote.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/number_column.hpp"

namespace stickslip::record {

/// For a child process with limits: HDF5 may not come back from a file that is damaged or made to deceive.
/// Thread-bound, movable.
class HdfColumns {
 public:
  /// Errors, without the file's name: kUsage for a damaged file; as open_shared().
  [[nodiscard]] static base::Result<HdfColumns> open(const std::filesystem::path& path);

  HdfColumns(HdfColumns&&) noexcept;
  HdfColumns& operator=(HdfColumns&&) noexcept;
  ~HdfColumns();

  /// Whether it is one of stickslip, of whatever version.
  [[nodiscard]] bool is_record() const;
  /// Of all datasets, by name: each numeric one, one for each member of a compound, one for each part of a
  /// matrix. A dataset that lies in another file is refused.
  [[nodiscard]] const std::vector<NumberColumn>& columns() const noexcept;

  /// Integers become the nearest double. Errors: kUsage, without the file's name.
  [[nodiscard]] base::Result<std::vector<double>> read(const NumberColumn& column) const;

 private:
  struct Opened;
  explicit HdfColumns(std::unique_ptr<Opened> opened);
  std::unique_ptr<Opened> opened_;
};

}  // namespace stickslip::record
