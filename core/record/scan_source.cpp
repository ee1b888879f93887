#include "core/record/scan_source.hpp"

#include <algorithm>
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

void ColumnScans::for_each_piece(const std::function<void(const ScanPiece&)>& use) const {
  std::vector<base::ScanIndex> scans;
  std::vector<double> values;
  for (std::size_t row = 0; row < size(); row += kPiece) {
    const std::size_t count = std::min(kPiece, size() - row);
    take_rows(scan, row, count, scans);
    take_rows(raw, row, count, values);
    use({scans, values});
  }
}

void ColumnScans::for_each_force_piece(const std::function<void(std::span<const double>)>& /*use*/) const {
  STICKSLIP_EXPECTS(has_force());
}

void ColumnScans::for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const {
  std::vector<std::int32_t> codes;
  for (std::size_t row = 0; row < size(); row += kPiece) {
    take_rows(second, row, std::min(kPiece, size() - row), codes);
    use(codes);
  }
}

}  // namespace stickslip::record
