/// \file
/// Long tables, of cycles and modes, written and read piece by piece, since they may exceed memory. The
/// functions throw HdfError; reading a base::LongColumn may throw std::system_error.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/long_column.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::record {

/// Rows in memory at a time: one chunk of the file, so that each chunk is compressed and decompressed once.
inline constexpr std::size_t kRowsPerPiece = ScanSource::kPiece;

/// Writes a whole column, one value for each row.
/// \param column  ColumnWriter or TextColumnWriter, made for rows.size() rows.
/// \param value_of  called with each row; returns its value.
template <typename Column, typename Row, typename ValueOf>
void write_rows(Column& column, const base::LongColumn<Row>& rows, const ValueOf& value_of) {
  std::vector<std::invoke_result_t<const ValueOf&, const Row&>> piece;
  piece.reserve(std::min(rows.size(), kRowsPerPiece));
  const auto pass_on = [&] {
    if (!piece.empty()) column.append(piece);
    piece.clear();
  };
  for (const Row& row : rows) {
    piece.push_back(value_of(row));
    if (piece.size() == kRowsPerPiece) pass_on();
  }
  pass_on();
}

/// Adds the column of one member of each row. \return its data set, for attributes.
template <typename Row, typename Value>
DatasetHandle write_member(TableWriter& table, const FieldName& name, const base::LongColumn<Row>& rows,
                           Value Row::*member) {
  ColumnWriter<Value> column = table.add_empty<Value>(name, rows.size());
  write_rows(column, rows, [member](const Row& row) { return row.*member; });
  return std::move(column).dataset();
}

/// Reads the column of one member into `rows`, from row `first` of the table on. Throws HdfError also if
/// the column does not have `table_rows` rows, those of the whole table.
template <typename Row, typename Value>
void read_member(hid_t group, const FieldName& name, Value Row::*member, std::size_t table_rows,
                 std::size_t first, std::vector<Row>& rows) {
  const std::string key{name.name};
  const DatasetHandle column = open_dataset(group, key);
  const std::size_t count = row_count(column, key);
  if (count != table_rows) throw HdfError(fmt::format("{} has {} rows, not {}", key, count, table_rows));
  if (rows.empty()) return;
  std::vector<Value> values(rows.size());
  read_rows<Value>(column, key, first, values);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*member = values[i];
}

/// Reads a table piece by piece.
/// \param key  column that tells how many rows there are.
/// \param read_piece  called as read_piece(first row, rows to be filled, rows in the table); once
///        for an empty table, without rows, to check its columns.
/// \param use  called with each row, in order.
template <typename Row, typename ReadPiece, typename Use>
void for_each_row(hid_t group, const std::string& key, const ReadPiece& read_piece, const Use& use) {
  const std::size_t count = row_count(group, key);
  std::size_t first = 0;
  do {  // Also an empty table has columns.
    std::vector<Row> rows(std::min(kRowsPerPiece, count - first));
    read_piece(first, rows, count);
    for (const Row& row : rows) use(row);
    first += rows.size();
  } while (first < count);
}

}  // namespace stickslip::record
