#include "core/base/long_column.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <future>
#include <numeric>
#include <system_error>
#include <utility>
#include <vector>

namespace stickslip::base {
namespace {

using Column = LongColumn<std::int64_t>;

/// More blocks than stay in memory, the last one not full.
constexpr std::size_t kSize = (2 * Column::kResident + 1) * Column::kBlock + 7;

Column counted(Column column) {
  for (std::size_t k = 0; k < kSize; ++k) column.push_back(static_cast<std::int64_t>(3 * k));
  return column;
}

TEST(LongColumn, GivesBackWhatLiesInTheFileForwardsBackwardsAndInLeaps) {
  const Column column = counted(Column{std::filesystem::temp_directory_path()});
  ASSERT_EQ(column.size(), kSize);
  std::int64_t expected = 0;
  for (const std::int64_t value : column) {
    ASSERT_EQ(value, expected);
    expected += 3;
  }
  for (auto at = column.rbegin(); at != column.rend(); at += 1001) {
    ASSERT_EQ(*at, 3 * (column.rend() - at - 1));
    if (column.rend() - at <= 1001) break;
  }
  for (std::size_t k = 0; k < kSize; k += Column::kBlock / 2 + 1) {
    ASSERT_EQ(column[k], 3 * static_cast<std::int64_t>(k));
    ASSERT_EQ(column.back(), 3 * static_cast<std::int64_t>(kSize - 1));
    ASSERT_EQ(column.front(), 0);
  }
  const auto found = std::lower_bound(column.begin(), column.end(), std::int64_t{1'200'000});
  EXPECT_EQ(found - column.begin(), 400'000);
}

TEST(LongColumn, GrowsAfterItWasRead) {
  Column column = counted(Column{std::filesystem::temp_directory_path()});
  EXPECT_EQ(std::as_const(column)[5], 15);  // Fetched; the last block is still being filled.
  for (std::size_t k = 0; k < 2 * Column::kBlock; ++k) column.push_back(7);
  EXPECT_EQ(std::as_const(column)[kSize - 1], 3 * static_cast<std::int64_t>(kSize - 1));
  EXPECT_EQ(std::as_const(column)[kSize], 7);
  EXPECT_EQ(column.back(), 7);
}

TEST(LongColumn, LosesItsLastElements) {
  for (const std::filesystem::path& folder :
       {std::filesystem::path{}, std::filesystem::temp_directory_path()}) {
    // Within the last block, to its beginning, and into one that lies in the file.
    for (const std::size_t size : {kSize - 3, kSize - 7, Column::kBlock + 5, std::size_t{0}}) {
      Column column = counted(Column{folder});
      EXPECT_EQ(std::as_const(column)[2 * Column::kBlock], 3 * static_cast<std::int64_t>(2 * Column::kBlock));
      column.truncate(size);
      ASSERT_EQ(column.size(), size);
      for (std::size_t k = 0; k < 6 * Column::kBlock; ++k) column.push_back(-1);
      for (std::size_t k = 0; k < column.size(); k += 97)
        ASSERT_EQ(std::as_const(column)[k], k < size ? 3 * static_cast<std::int64_t>(k) : -1) << size;
      EXPECT_EQ(column.back(), -1);
      column.pop_back();
      EXPECT_EQ(column.size(), size + 6 * Column::kBlock - 1);
    }
  }
}

TEST(LongColumn, IsReadInTwoThreadsByAView) {
  for (const std::filesystem::path& folder :
       {std::filesystem::path{}, std::filesystem::temp_directory_path()}) {
    const Column column = counted(Column{folder});
    const auto sum = [](const Column& numbers) {
      return std::accumulate(numbers.begin(), numbers.end(), std::int64_t{0});
    };
    auto other = std::async(std::launch::async, sum, column.view());
    constexpr auto kCount = static_cast<std::int64_t>(kSize);
    EXPECT_EQ(sum(column), 3 * kCount * (kCount - 1) / 2);
    EXPECT_EQ(other.get(), sum(column));
  }
  // A view outlives its column.
  const Column view = counted(Column{std::filesystem::temp_directory_path()}).view();
  EXPECT_EQ(view[1], 3);
  EXPECT_TRUE(Column{}.view().empty());
}

TEST(LongColumn, WithoutAFolderIsAVectorThatMayBeChangedAndCopied) {
  Column column{std::vector<std::int64_t>{1, 2, 3}};
  column[1] = 20;
  const Column copy = column;
  for (std::int64_t& value : column) value = 0;
  EXPECT_EQ(std::vector<std::int64_t>(copy.begin(), copy.end()), (std::vector<std::int64_t>{1, 20, 3}));
  EXPECT_EQ(column.back(), 0);
  column.assign(2, 9);
  EXPECT_EQ(column.size(), 2U);
}

/// As wide as the row of a table.
struct Row {
  std::int64_t number = 0;
  double value = 0.0;
  std::uint8_t flags = 0;
};

TEST(LongColumn, HoldsRowsOfATable) {
  using Rows = LongColumn<Row>;
  static_assert(Rows::kBlock * sizeof(Row) <= 1U << 15U);
  Rows rows{std::filesystem::temp_directory_path()};
  const std::size_t size = 3 * Rows::kResident * Rows::kBlock + 1;
  for (std::size_t k = 0; k < size; ++k) {
    rows.push_back(
        {static_cast<std::int64_t>(k), 0.5 * static_cast<double>(k), static_cast<std::uint8_t>(k)});
  }
  std::size_t k = 0;
  for (const Row& row : std::as_const(rows)) {
    ASSERT_EQ(row.number, static_cast<std::int64_t>(k));
    ASSERT_EQ(row.value, 0.5 * static_cast<double>(k));
    ASSERT_EQ(row.flags, static_cast<std::uint8_t>(k));
    ++k;
  }
  EXPECT_EQ(k, size);
  rows.clear();
  EXPECT_TRUE(rows.empty());
  const Rows two = {{1, 0.1, 1}, {2, 0.2, 0}};
  EXPECT_EQ(two.size(), 2U);
  EXPECT_EQ(two[1].value, 0.2);
}

TEST(LongColumn, SaysInWhichFolderThereIsNoRoom) {
  // As long as it stays in memory it asks for none.
  Column column{std::filesystem::path{"/nowhere at all"}};
  for (std::size_t k = 0; k < Column::kResident * Column::kBlock; ++k) column.push_back(1);
  EXPECT_THROW(column.push_back(1), std::system_error);
}

}  // namespace
}  // namespace stickslip::base
