#include "core/record/scan_source.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/base/contract.hpp"

namespace stickslip::record {
namespace {

/// Copies rows [row, row + count), which may be in a file, into a piece.
template <typename T>
void take_rows(const base::LongColumn<T>& column, std::size_t row, std::size_t count, std::vector<T>& piece) {
  piece.resize(count);
  for (std::size_t i = 0; i < count; ++i) piece[i] = column[row + i];
}

}  // namespace

void RecordScans::for_each_piece(const std::function<void(const ScanPiece&)>& use) const {
  for (std::size_t row = 0; row < size(); row += kPiece) {
    const std::size_t count = std::min(kPiece, size() - row);
    use({std::span{record_.scan}.subspan(row, count), std::span{record_.raw}.subspan(row, count)});
  }
}

void RecordScans::for_each_force_piece(const std::function<void(std::span<const double>)>& use) const {
  for (std::size_t row = 0; row < size(); row += kPiece) {
    use(std::span{record_.true_coefficient}.subspan(row, std::min(kPiece, size() - row)));
  }
}

void RecordScans::for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const {
  for (std::size_t row = 0; row < size(); row += kPiece) {
    use(std::span{record_.second}.subspan(row, std::min(kPiece, size() - row)));
  }
}

ColumnScans::ColumnScans(std::shared_ptr<const ScanColumns> columns, std::size_t first, std::size_t count)
    : columns_(std::move(columns)), first_(first), count_(count) {
  STICKSLIP_EXPECTS(columns_->raw.size() == columns_->scan.size());
  STICKSLIP_EXPECTS(columns_->second.empty() || columns_->second.size() == columns_->scan.size());
  STICKSLIP_EXPECTS(first <= columns_->scan.size() && count <= columns_->scan.size() - first);
}

std::int64_t ColumnScans::extent() const {
  return count_ == 0 ? 0 : columns_->scan[first_ + count_ - 1] - columns_->scan[first_] + 1;
}

void ColumnScans::for_each_piece(const std::function<void(const ScanPiece&)>& use) const {
  std::vector<base::ScanIndex> scans;
  std::vector<double> values;
  for (std::size_t row = 0; row < count_; row += kPiece) {
    const std::size_t count = std::min(kPiece, count_ - row);
    take_rows(columns_->scan, first_ + row, count, scans);
    take_rows(columns_->raw, first_ + row, count, values);
    use({scans, values});
  }
}

void ColumnScans::for_each_force_piece(const std::function<void(std::span<const double>)>& /*use*/) const {
  STICKSLIP_EXPECTS(has_force());
}

void ColumnScans::for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const {
  std::vector<std::int32_t> codes;
  for (std::size_t row = 0; row < count_; row += kPiece) {
    take_rows(columns_->second, first_ + row, std::min(kPiece, count_ - row), codes);
    use(codes);
  }
}

}  // namespace stickslip::record
