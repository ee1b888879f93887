/// \file
/// Rows of a column of a trace as the importer counts them: from either end, in SI units.
#pragma once

#include <cstddef>

#include "core/base/long_column.hpp"

namespace stickslip::traces {

/// View; the column must outlive it.
class RowView {
 public:
  RowView() = default;
  /// (value − offset)·scale of each row, from the last row to the first if `reversed`.
  RowView(const base::LongColumn<double>& column, double offset, double scale, bool reversed)
      : column_(&column), size_(column.size()), offset_(offset), scale_(scale), reversed_(reversed) {}

  RowView(base::LongColumn<double>&&, double, double, bool) = delete;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] double operator[](std::size_t row) const {
    const std::size_t at = first_ + row;
    return scale_ * ((*column_)[reversed_ ? column_->size() - 1 - at : at] - offset_);
  }
  [[nodiscard]] double front() const { return (*this)[0]; }
  [[nodiscard]] double back() const { return (*this)[size_ - 1]; }

  /// Rows [first, first + count).
  [[nodiscard]] RowView part(std::size_t first, std::size_t count) const {
    RowView view = *this;
    view.first_ += first;
    view.size_ = count;
    return view;
  }

 private:
  const base::LongColumn<double>* column_ = nullptr;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  double offset_ = 0.0;
  double scale_ = 1.0;
  bool reversed_ = false;
};

}  // namespace stickslip::traces
