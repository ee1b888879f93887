// Scans that are longer than memory are those that were put in, piece by piece.

#include "core/record/scan_source.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <vector>

namespace stickslip::record {
namespace {

struct Taken {
  std::vector<base::ScanIndex> scan;
  std::vector<double> raw;
  std::vector<std::int32_t> second;
};

Taken taken_from(const ScanSource& scans) {
  Taken taken;
  scans.for_each_piece([&taken](const ScanPiece& piece) {
    EXPECT_EQ(piece.scan.size(), piece.raw.size());
    taken.scan.insert(taken.scan.end(), piece.scan.begin(), piece.scan.end());
    taken.raw.insert(taken.raw.end(), piece.raw.begin(), piece.raw.end());
  });
  if (!scans.has_second()) return taken;
  scans.for_each_second_piece([&taken](std::span<const std::int32_t> piece) {
    taken.second.insert(taken.second.end(), piece.begin(), piece.end());
  });
  return taken;
}

TEST(ColumnScans, OfARangeAreThoseOfARecordWithTheseRows) {
  constexpr std::size_t kRows = 6 * base::LongColumn<double>::kBlock + 7;
  for (const bool has_second : {true, false}) {
    const auto columns = std::make_shared<ScanColumns>(std::filesystem::temp_directory_path());
    Record whole;
    for (std::size_t row = 0; row < kRows; ++row) {
      whole.scan.push_back(static_cast<base::ScanIndex>(3 * row + 5));
      whole.raw.push_back(0.25 * static_cast<double>(row));
      columns->scan.push_back(whole.scan.back());
      columns->raw.push_back(whole.raw.back());
      if (!has_second) continue;
      whole.second.push_back(static_cast<std::int32_t>(row % 4096));
      columns->second.push_back(whole.second.back());
    }
    // All of them, some in the middle, the last one, none.
    for (const auto& [first, count] :
         {std::pair{std::size_t{0}, kRows}, std::pair{std::size_t{70'001}, std::size_t{100'003}},
          std::pair{kRows - 1, std::size_t{1}}, std::pair{kRows, std::size_t{0}}}) {
      SCOPED_TRACE(first);
      const auto part = [first = first, count = count](const auto& column) {
        return std::decay_t<decltype(column)>(column.begin() + static_cast<std::ptrdiff_t>(first),
                                              column.begin() + static_cast<std::ptrdiff_t>(first + count));
      };
      Record record;
      record.scan = part(whole.scan);
      record.raw = part(whole.raw);
      if (has_second) record.second = part(whole.second);
      const ColumnScans scans{columns, first, count};
      const RecordScans expected{record};
      EXPECT_EQ(scans.size(), expected.size());
      EXPECT_EQ(scans.extent(), expected.extent());
      const Taken found = taken_from(scans);
      EXPECT_TRUE(found.scan == record.scan);
      EXPECT_TRUE(found.raw == record.raw);
      EXPECT_TRUE(found.second == record.second);
    }
  }
}

}  // namespace
}  // namespace stickslip::record
