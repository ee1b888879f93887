/// \file
/// Columns of numbers in a file of MATLAB, versions 4 to 7.3 [libmatio].
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.hpp"
#include "core/record/number_column.hpp"

namespace stickslip::traces {

/// Whether a file begins as one of MATLAB does. Version 4 has no mark: its first header must be possible.
[[nodiscard]] bool is_matlab(std::string_view head);

/// For a child process with limits: libmatio may not come back from a file that is damaged or made to
/// deceive. Thread-bound, movable.
class MatlabColumns {
 public:
  /// Errors, without the file's name: kUsage for a file that is damaged or cut short.
  [[nodiscard]] static base::Result<MatlabColumns> open(const std::string& path);

  MatlabColumns(MatlabColumns&&) noexcept;
  MatlabColumns& operator=(MatlabColumns&&) noexcept;
  ~MatlabColumns();

  /// "MATLAB 5".
  [[nodiscard]] std::string format() const;
  /// Of all variables in their order, fields of a struct as "run.force"; one for each part of a matrix.
  [[nodiscard]] const std::vector<record::NumberColumn>& columns() const noexcept;

  /// Integers, logicals and singles become doubles. Errors: kUsage, without the file's name.
  [[nodiscard]] base::Result<std::vector<double>> read(const record::NumberColumn& column);

 private:
  struct Opened;
  explicit MatlabColumns(std::unique_ptr<Opened> opened);
  std::unique_ptr<Opened> opened_;
};

}  // namespace stickslip::traces
