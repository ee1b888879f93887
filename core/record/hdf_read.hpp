/// \file
/// Reads data sets and attributes of untrusted files. All functions except has() throw HdfError that names
/// the object and the fault. Numbers must be stored as type T exactly (kind, size, sign), little-endian. A
/// column of more than 2²⁸ rows is refused, also by row_count(), and so are more than 64 MiB of texts of data
/// sets in one call.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/record/fields.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// Whether a link of that name exists in the group; false also on an error.
[[nodiscard]] bool has(hid_t parent, const std::string& name);

/// Names of all links of a group, rising. \param group_name  for messages. \param most  more are refused.
[[nodiscard]] std::vector<std::string> names_in(hid_t group, const std::string& group_name, std::size_t most);

[[nodiscard]] GroupHandle open_group(hid_t parent, const std::string& name);

/// Attribute that is one variable-length text.
[[nodiscard]] std::string read_attribute(hid_t object, const std::string& name);
/// As read_attribute(); nullopt if there is none, or HDF5 cannot tell.
[[nodiscard]] std::optional<std::string> find_attribute(hid_t object, const std::string& name);
/// Attribute that is one number; nullopt if there is none, or HDF5 cannot tell.
template <typename T>
[[nodiscard]] std::optional<T> find_number_attribute(hid_t object, const std::string& name);

[[nodiscard]] DatasetHandle open_dataset(hid_t parent, const std::string& name);

/// Single text of fixed length, without the zero bytes at its end.
[[nodiscard]] std::string read_text(hid_t parent, const std::string& name);
[[nodiscard]] std::string read_text(const DatasetHandle& dataset, const std::string& name);
/// Column of such texts.
[[nodiscard]] std::vector<std::string> read_texts(hid_t parent, const std::string& name);
template <typename T>
[[nodiscard]] T read_scalar(hid_t parent, const std::string& name);
/// Reads an open data set. \param name  for messages.
template <typename T>
[[nodiscard]] T read_scalar(const DatasetHandle& dataset, const std::string& name);
/// \param count  required length, if known.
template <typename T>
[[nodiscard]] std::vector<T> read_column(hid_t parent, const std::string& name,
                                         std::optional<std::size_t> count = std::nullopt);
/// Rows [first, first + values.size()) of a column of type T. Call row_count() before, which refuses
/// a data set that has not exactly one dimension.
template <typename T>
void read_rows(const DatasetHandle& column, const std::string& name, std::size_t first, std::span<T> values);
/// Rows [first, first + count) of a column of texts. Call row_count() before, as for read_rows().
[[nodiscard]] std::vector<std::string> read_text_rows(const DatasetHandle& column, const std::string& name,
                                                      std::size_t first, std::size_t count);
/// Number of rows of a column.
[[nodiscard]] std::size_t row_count(hid_t parent, const std::string& name);
[[nodiscard]] std::size_t row_count(const DatasetHandle& dataset, const std::string& name);
/// Whether the stored type of a data set is T.
template <typename T>
[[nodiscard]] bool holds(hid_t parent, const std::string& name);

/// Visitor for for_each_field() that reads the fields; inverse of FieldWriter. A text, vector or optional
/// that is not in the file becomes empty; a missing number throws HdfError.
class FieldReader {
 public:
  explicit FieldReader(hid_t parent) : parent_(parent) {}

  void operator()(const FieldName& name, std::string& text) const {
    const std::string key{name.name};
    text = has(parent_, key) ? read_text(parent_, key) : std::string{};
  }
  void operator()(const FieldName& name, std::vector<double>& values) const {
    const std::string key{name.name};
    values = has(parent_, key) ? read_column<double>(parent_, key) : std::vector<double>{};
  }
  void operator()(const FieldName& name, std::vector<std::string>& texts) const {
    const std::string key{name.name};
    texts = has(parent_, key) ? read_texts(parent_, key) : std::vector<std::string>{};
  }
  template <typename T>
  void operator()(const FieldName& name, std::optional<T>& value) const {
    const std::string key{name.name};
    value = has(parent_, key) ? std::optional<T>{read_scalar<T>(parent_, key)} : std::nullopt;
  }
  template <typename T>
  void operator()(const FieldName& name, T& value) const {
    value = read_scalar<T>(parent_, std::string{name.name});
  }

 private:
  hid_t parent_;
};

}  // namespace stickslip::record
