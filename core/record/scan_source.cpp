#include "core/record/scan_source.hpp"

#include <algorithm>

namespace stickslip::record {

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

}  // namespace stickslip::record
