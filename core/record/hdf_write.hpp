/// \file
/// Writes data sets and attributes. Data sets of numbers have the attributes units and long_name; texts are
/// UTF-8 as viewers and readers of several languages can read them. All functions throw HdfError.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/record/fields.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// Creates a file, open for writing, in a format that HDF5 1.8 and later read. An old file at `path` is
/// unlinked first. Clears unclosed(). \param calls  must outlive the file.
[[nodiscard]] FileHandle create_file(const std::filesystem::path& path,
                                     const FileCalls& calls = system_calls());

/// Flushes, closes and syncs a file of create_file(). All other handles of the file must be closed before.
/// \throws HdfError also if one of them is open or could not be closed (unclosed()).
void finish_file(FileHandle file);

/// \param nx_class  NeXus class, e.g. "NXdata".
[[nodiscard]] GroupHandle make_group(hid_t parent, const std::string& name, const std::string& nx_class);

/// Variable-length UTF-8 attribute.
void write_attribute(hid_t object, const std::string& name, std::string_view text);
/// Array of variable-length UTF-8 texts as an attribute. \param texts  not empty (HdfError).
void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts);
/// Number as an attribute, without unit.
template <typename T>
void write_number_attribute(hid_t object, const std::string& name, T value);

/// Scalar text as a fixed-length UTF-8 data set.
DatasetHandle write_text(hid_t parent, const std::string& name, std::string_view text);
/// Scalar number.
template <typename T>
DatasetHandle write_scalar(hid_t parent, const FieldName& name, T value);
/// Column of numbers: chunked, compressed, checksummed; contiguous if empty.
template <typename T>
DatasetHandle write_column(hid_t parent, const FieldName& name, std::span<const T> values);
/// A column of known length that is written piece by piece; as write_column().
template <typename T>
class ColumnWriter {
 public:
  ColumnWriter(hid_t parent, const FieldName& name, std::size_t count);

  /// The next rows; not more than are left.
  void append(std::span<const T> values);

  [[nodiscard]] const DatasetHandle& dataset() const& noexcept { return dataset_; }
  /// The data set, after all rows were appended.
  [[nodiscard]] DatasetHandle dataset() && noexcept { return std::move(dataset_); }

 private:
  std::string name_;
  DatasetHandle dataset_;
  hsize_t row_ = 0;
};

/// A column of texts of a fixed length that is written piece by piece; as write_texts().
class TextColumnWriter {
 public:
  /// \param width  bytes of the longest text, at least 1.
  TextColumnWriter(hid_t parent, const std::string& name, std::size_t width, std::size_t count);

  /// The next rows; not more than are left.
  void append(std::span<const std::string_view> texts);

  [[nodiscard]] const DatasetHandle& dataset() const noexcept { return dataset_; }

 private:
  std::string name_;
  std::size_t width_;
  TypeHandle type_;
  DatasetHandle dataset_;
  hsize_t row_ = 0;
};

/// Column of texts of fixed length, not compressed.
DatasetHandle write_texts(hid_t parent, const std::string& name, const std::vector<std::string>& texts);

/// Attaches a dimension scale, for example that of another table, to a column. \param name  of the column,
/// for messages.
void attach_scale(const DatasetHandle& column, const DatasetHandle& scale, const std::string& name);
/// Array of numbers in row-major order; stored as by write_column().
/// \param values  as many as the product of `shape`, which is not checked.
template <typename T>
DatasetHandle write_array(hid_t parent, const FieldName& name, std::span<const hsize_t> shape,
                          std::span<const T> values);
/// Array of texts; fixed length, compressed.
/// \param shape  nowhere zero.
/// \param texts  as many as the product of `shape`, which is not checked.
DatasetHandle write_text_array(hid_t parent, const std::string& name, std::span<const hsize_t> shape,
                               const std::vector<std::string_view>& texts);

/// A group whose data sets are the columns of one table; the first column added is the dimension scale of the
/// others.
class TableWriter {
 public:
  explicit TableWriter(GroupHandle group) : group_(std::move(group)) {}

  /// Adds a column. \return its data set, for attributes.
  template <typename T>
  DatasetHandle add(const FieldName& name, std::span<const T> values) {
    return attached(write_column(group_.get(), name, values), std::string{name.name});
  }
  template <typename T>
  DatasetHandle add(const FieldName& name, const std::vector<T>& values) {
    return add(name, std::span<const T>{values});
  }
  DatasetHandle add(const std::string& name, const std::vector<std::string>& texts) {
    return attached(write_texts(group_.get(), name, texts), name);
  }

  /// Adds a column to be written piece by piece afterwards.
  template <typename T>
  [[nodiscard]] ColumnWriter<T> add_empty(const FieldName& name, std::size_t count) {
    ColumnWriter<T> column{group_.get(), name, count};
    attach(column.dataset(), std::string{name.name});
    return column;
  }

  [[nodiscard]] TextColumnWriter add_empty_texts(const std::string& name, std::size_t width,
                                                 std::size_t count) {
    TextColumnWriter column{group_.get(), name, width, count};
    attach(column.dataset(), name);
    return column;
  }

  [[nodiscard]] hid_t group() const noexcept { return group_.get(); }

 private:
  /// Makes the first column the scale; attaches the scale to others.
  void attach(const DatasetHandle& column, const std::string& name);
  DatasetHandle attached(DatasetHandle column, const std::string& name) {
    attach(column, name);
    return column;
  }

  GroupHandle group_;
  std::vector<DatasetHandle> scale_;  ///< The scale; empty before the first column.
};

/// Visitor for for_each_field(): writes one data set for each field that is not empty.
class FieldWriter {
 public:
  explicit FieldWriter(hid_t parent) : parent_(parent) {}

  void operator()(const FieldName& name, const std::string& text) const {
    if (!text.empty()) write_text(parent_, std::string{name.name}, text);
  }
  void operator()(const FieldName& name, const std::vector<double>& values) const {
    if (!values.empty()) write_column(parent_, name, std::span<const double>{values});
  }
  void operator()(const FieldName& name, const std::vector<std::string>& texts) const {
    if (!texts.empty()) write_texts(parent_, std::string{name.name}, texts);
  }
  template <typename T>
  void operator()(const FieldName& name, const std::optional<T>& value) const {
    if (value) write_scalar(parent_, name, *value);
  }
  template <typename T>
  void operator()(const FieldName& name, const T& value) const {
    write_scalar(parent_, name, value);
  }

 private:
  hid_t parent_;
};

}  // namespace stickslip::record
