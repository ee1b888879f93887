/// \file
/// Writing data sets and attributes: every number with units and long_name, strings as viewers and
/// readers of several languages can read them. All functions throw HdfError.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/record/fields.hpp"
#include "core/record/hdf.hpp"

namespace stickslip::record {

/// \param nx_class  NeXus class, e.g. "NXdata".
[[nodiscard]] GroupHandle make_group(hid_t parent, const std::string& name, const std::string& nx_class);

/// Variable-length UTF-8 attribute.
void write_attribute(hid_t object, const std::string& name, std::string_view text);
/// The same, an array.
void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts);
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
/// Column of texts, fixed length.
DatasetHandle write_texts(hid_t parent, const std::string& name, const std::vector<std::string>& texts);

/// A group whose data sets are the columns of one table; the first is the scale of the others.
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

  [[nodiscard]] hid_t group() const noexcept { return group_.get(); }

 private:
  DatasetHandle attached(DatasetHandle column, const std::string& name);

  GroupHandle group_;
  std::vector<DatasetHandle> scale_;  ///< One, once there is a column.
};

/// Visitor for for_each_field(): one scalar data set per known fact.
class FieldWriter {
 public:
  explicit FieldWriter(hid_t parent) : parent_(parent) {}

  void operator()(const FieldName& name, const std::string& text) const {
    if (!text.empty()) write_text(parent_, std::string{name.name}, text);
  }
  void operator()(const FieldName& name, const std::vector<double>& values) const {
    write_column(parent_, name, std::span<const double>{values});
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
