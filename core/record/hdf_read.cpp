#include "core/record/hdf_read.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace stickslip::record {
namespace {

/// Longest column read: 268 million scans (nine days at 350/s), 2 GiB. A file may claim more than
/// any memory holds.
constexpr hsize_t kLongestColumn = hsize_t{1} << 28U;
/// Longest text read: configuration and scene are some kilobytes.
constexpr std::size_t kLongestText = std::size_t{1} << 26U;

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw HdfError(fmt::format("{} {}", name, what));
}

/// Elements of a scalar (dimensions = 0) or a column (1).
std::size_t count_in(const SpaceHandle& space, int dimensions, const std::string& name) {
  if (H5Sget_simple_extent_type(space.get()) == H5S_NULL ||
      H5Sget_simple_extent_ndims(space.get()) != dimensions) {
    refuse(name, dimensions == 0 ? "is no single value" : "is no column");
  }
  hsize_t count = 1;
  if (dimensions == 1) check(H5Sget_simple_extent_dims(space.get(), &count, nullptr), "length of " + name);
  if (count > kLongestColumn) {
    refuse(name, fmt::format("has {} rows, at most {} are read", count, kLongestColumn));
  }
  return static_cast<std::size_t>(count);
}

template <typename T>
bool is_number(hid_t type) {
  return H5Tequal(type, NumberType<T>::file()) > 0;
}

TypeHandle type_of(const DatasetHandle& dataset, const std::string& name) {
  return {H5Dget_type(dataset.get()), "type of " + name};
}
SpaceHandle space_of(const DatasetHandle& dataset, const std::string& name) {
  return {H5Dget_space(dataset.get()), "space of " + name};
}

/// \throws HdfError unless the type is a fixed-length string; \return its length.
std::size_t text_width(const TypeHandle& type, std::size_t count, const std::string& name) {
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0) {
    refuse(name, "is no fixed-length text");
  }
  const std::size_t width = H5Tget_size(type.get());
  if (width == 0 || width * count > kLongestText) refuse(name, "is too long a text");
  return width;
}

/// \param all  `width` bytes each.
std::vector<std::string> texts_in(const std::string& all, std::size_t width) {
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < all.size(); at += width) {
    std::string text = all.substr(at, width);
    text.erase(text.find_last_not_of('\0') + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

std::vector<std::string> texts_of(const DatasetHandle& dataset, const std::string& name, int dimensions) {
  const TypeHandle type = type_of(dataset, name);
  const std::size_t count = count_in(space_of(dataset, name), dimensions, name);
  const std::size_t width = text_width(type, count, name);
  std::string all(width * count, '\0');
  check(H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), "reading " + name);
  return texts_in(all, width);
}

template <typename T>
std::vector<T> numbers_in(const DatasetHandle& dataset, const std::string& name, int dimensions,
                          std::optional<std::size_t> expected) {
  if (!is_number<T>(type_of(dataset, name).get())) refuse(name, "has another type than this format says");
  const std::size_t count = count_in(space_of(dataset, name), dimensions, name);
  if (expected && count != *expected) refuse(name, fmt::format("has {} rows, not {}", count, *expected));
  std::vector<T> values(count);
  check(H5Dread(dataset.get(), NumberType<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        fmt::format("reading {} (cut short or damaged)", name));
  return values;
}

}  // namespace

bool has(hid_t parent, const std::string& name) { return H5Lexists(parent, name.c_str(), H5P_DEFAULT) > 0; }

std::vector<std::string> names_in(hid_t group, const std::string& group_name, std::size_t most) {
  H5G_info_t info{};
  check(H5Gget_info(group, &info), "links of " + group_name);
  if (info.nlinks > most) {
    refuse(group_name, fmt::format("has {} names, at most {} are read", info.nlinks, most));
  }
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto name_of = [&](char* text, std::size_t size) {
      return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, text, size, H5P_DEFAULT);
    };
    const ssize_t size = name_of(nullptr, 0);
    if (size < 0) throw_refused("links of " + group_name);
    std::string name(static_cast<std::size_t>(size) + 1, '\0');
    if (name_of(name.data(), name.size()) < 0) throw_refused("links of " + group_name);
    name.pop_back();
    names.push_back(std::move(name));
  }
  return names;
}

GroupHandle open_group(hid_t parent, const std::string& name) {
  if (!has(parent, name)) refuse("group " + name, "is missing");
  const hid_t group = H5Gopen2(parent, name.c_str(), H5P_DEFAULT);
  if (group < 0) refuse(name, "is no group or damaged");
  return {group, name};
}

std::optional<std::string> find_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return std::nullopt;
  const AttributeHandle attribute{H5Aopen(object, name.c_str(), H5P_DEFAULT), "attribute " + name};
  const TypeHandle type{H5Aget_type(attribute.get()), "type of attribute " + name};
  const SpaceHandle space{H5Aget_space(attribute.get()), "space of attribute " + name};
  static_cast<void>(count_in(space, 0, "attribute " + name));
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) <= 0) {
    refuse("attribute " + name, "is no variable-length text");
  }
  char* value = nullptr;
  check(H5Aread(attribute.get(), type.get(), &value), "reading attribute " + name);
  const std::unique_ptr<char, herr_t (*)(void*)> owner{value, H5free_memory};
  return value == nullptr ? std::string{} : std::string{value};
}

std::string read_attribute(hid_t object, const std::string& name) {
  auto text = find_attribute(object, name);
  if (!text) refuse("attribute " + name, "is missing");
  return *std::move(text);
}

template <typename T>
std::optional<T> find_number_attribute(hid_t object, const std::string& name) {
  if (H5Aexists(object, name.c_str()) <= 0) return std::nullopt;
  const AttributeHandle attribute{H5Aopen(object, name.c_str(), H5P_DEFAULT), "attribute " + name};
  const TypeHandle type{H5Aget_type(attribute.get()), "type of attribute " + name};
  const SpaceHandle space{H5Aget_space(attribute.get()), "space of attribute " + name};
  static_cast<void>(count_in(space, 0, "attribute " + name));
  if (!is_number<T>(type.get())) refuse("attribute " + name, "has another type than this format says");
  T value{};
  check(H5Aread(attribute.get(), NumberType<T>::memory(), &value), "reading attribute " + name);
  return value;
}

DatasetHandle open_dataset(hid_t parent, const std::string& name) {
  const hid_t dataset = H5Dopen2(parent, name.c_str(), H5P_DEFAULT);
  if (dataset < 0 && !has(parent, name)) refuse("data set " + name, "is missing");
  if (dataset < 0) refuse(name, "is no data set or damaged");
  return {dataset, name};
}

std::string read_text(const DatasetHandle& dataset, const std::string& name) {
  return texts_of(dataset, name, 0).front();
}

std::string read_text(hid_t parent, const std::string& name) {
  return read_text(open_dataset(parent, name), name);
}

std::vector<std::string> read_texts(hid_t parent, const std::string& name) {
  return texts_of(open_dataset(parent, name), name, 1);
}

template <typename T>
T read_scalar(const DatasetHandle& dataset, const std::string& name) {
  return numbers_in<T>(dataset, name, 0, std::nullopt).front();
}

template <typename T>
T read_scalar(hid_t parent, const std::string& name) {
  return read_scalar<T>(open_dataset(parent, name), name);
}

template <typename T>
std::vector<T> read_column(hid_t parent, const std::string& name, std::optional<std::size_t> count) {
  return numbers_in<T>(open_dataset(parent, name), name, 1, count);
}

template <typename T>
void read_rows(const DatasetHandle& column, const std::string& name, std::size_t first, std::span<T> values) {
  if (!is_number<T>(type_of(column, name).get())) refuse(name, "has another type than this format says");
  const hsize_t row = first;
  const hsize_t count = values.size();
  const SpaceHandle file = space_of(column, name);
  check(H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, &row, nullptr, &count, nullptr), "rows of " + name);
  const SpaceHandle memory{H5Screate_simple(1, &count, nullptr), "rows of " + name};
  check(H5Dread(column.get(), NumberType<T>::memory(), memory.get(), file.get(), H5P_DEFAULT, values.data()),
        fmt::format("reading {} (cut short or damaged)", name));
}

std::vector<std::string> read_text_rows(const DatasetHandle& column, const std::string& name,
                                        std::size_t first, std::size_t count) {
  const TypeHandle type = type_of(column, name);
  const std::size_t width = text_width(type, count, name);
  const hsize_t row = first;
  const hsize_t rows = count;
  const SpaceHandle file = space_of(column, name);
  check(H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, &row, nullptr, &rows, nullptr), "rows of " + name);
  const SpaceHandle memory{H5Screate_simple(1, &rows, nullptr), "rows of " + name};
  std::string all(width * count, '\0');
  check(H5Dread(column.get(), type.get(), memory.get(), file.get(), H5P_DEFAULT, all.data()),
        "reading " + name);
  return texts_in(all, width);
}

std::size_t row_count(const DatasetHandle& dataset, const std::string& name) {
  return count_in(space_of(dataset, name), 1, name);
}

std::size_t row_count(hid_t parent, const std::string& name) {
  return row_count(open_dataset(parent, name), name);
}

template <typename T>
bool holds(hid_t parent, const std::string& name) {
  const DatasetHandle dataset = open_dataset(parent, name);
  return is_number<T>(type_of(dataset, name).get());
}

#define STICKSLIP_INSTANTIATE(type)                                                                \
  template type read_scalar(hid_t, const std::string&);                                            \
  template type read_scalar(const DatasetHandle&, const std::string&);                             \
  template std::vector<type> read_column(hid_t, const std::string&, std::optional<std::size_t>);   \
  template bool holds<type>(hid_t, const std::string&);                                            \
  template void read_rows(const DatasetHandle&, const std::string&, std::size_t, std::span<type>); \
  template std::optional<type> find_number_attribute(hid_t, const std::string&)
STICKSLIP_INSTANTIATE(double);
STICKSLIP_INSTANTIATE(float);
STICKSLIP_INSTANTIATE(std::int64_t);
STICKSLIP_INSTANTIATE(std::uint64_t);
STICKSLIP_INSTANTIATE(std::int32_t);
STICKSLIP_INSTANTIATE(std::uint32_t);
STICKSLIP_INSTANTIATE(std::uint16_t);
STICKSLIP_INSTANTIATE(std::uint8_t);
#undef STICKSLIP_INSTANTIATE

}  // namespace stickslip::record
