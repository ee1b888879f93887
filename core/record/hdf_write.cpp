#include "core/record/hdf_write.hpp"

#include <hdf5_hl.h>

#include <algorithm>

#include "core/record/hdf_driver.hpp"
#include "core/record/scan_source.hpp"

namespace stickslip::record {
namespace {

/// 100 s at 350 scans/s: a viewer reads little to show little. Measured: deflate 2 with shuffle
/// leaves 46 % of the raw size; 4 leaves 1 to 3 % less of that and takes 1.4 times as long.
constexpr hsize_t kChunk = ScanSource::kPiece;
constexpr unsigned kDeflateLevel = 2;

TypeHandle text_type(std::size_t size) {
  TypeHandle type{H5Tcopy(H5T_C_S1), "copy of the string type"};
  check(H5Tset_size(type.get(), size), "string size");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "UTF-8");
  check(H5Tset_strpad(type.get(), size == H5T_VARIABLE ? H5T_STR_NULLTERM : H5T_STR_NULLPAD), "padding");
  return type;
}

/// For data sets and groups. Times of objects are not kept: equal records are equal files.
PropertyHandle dataset_properties() {
  PropertyHandle properties{H5Pcreate(H5P_DATASET_CREATE), "data set properties"};
  check(H5Pset_attr_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
        "creation order");
  check(H5Pset_obj_track_times(properties.get(), false), "object times");
  return properties;
}

SpaceHandle array_space(std::span<const hsize_t> shape) {
  return {H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), "array space"};
}

SpaceHandle column_space(std::size_t count) {
  const hsize_t size = count;
  return array_space({&size, 1});
}

/// Chunked along the last dimensions, compressed, checksummed. \param shape  nowhere zero.
PropertyHandle compressed_properties(std::span<const hsize_t> shape) {
  PropertyHandle properties = dataset_properties();
  std::vector<hsize_t> chunk(shape.size());
  hsize_t room = kChunk;
  for (std::size_t i = shape.size(); i-- > 0;) {
    chunk[i] = std::clamp<hsize_t>(room, 1, shape[i]);
    room /= chunk[i];
  }
  check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), "chunk");
  check(H5Pset_shuffle(properties.get()), "shuffle");
  check(H5Pset_deflate(properties.get(), kDeflateLevel), "deflate");
  check(H5Pset_fletcher32(properties.get()), "fletcher32");
  return properties;
}

DatasetHandle make_dataset(hid_t parent, const std::string& name, hid_t type, const SpaceHandle& space,
                           const PropertyHandle& properties) {
  return {H5Dcreate2(parent, name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
          "data set " + name};
}

void write_meaning(const DatasetHandle& dataset, const FieldName& name) {
  write_attribute(dataset.get(), "units", name.unit);
  write_attribute(dataset.get(), "long_name", name.long_name);
}

AttributeHandle make_attribute(hid_t object, const std::string& name, hid_t type, const SpaceHandle& space) {
  return {H5Acreate2(object, name.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT), "attribute " + name};
}

}  // namespace

FileHandle create_file(const std::filesystem::path& path, const FileCalls& calls) {
  prepare_hdf5();
  unclosed().clear();
  const PropertyHandle access{H5Pcreate(H5P_FILE_ACCESS), "file access properties"};
  // Readable by HDF5 1.8, MATLAB before R2021b and JavaScript readers.
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), "library version bounds");
  // A leaked handle makes closing fail instead of leaving the file half open.
  check(H5Pset_fclose_degree(access.get(), H5F_CLOSE_SEMI), "close degree");
  write_through(access, calls);
  const PropertyHandle creation{H5Pcreate(H5P_FILE_CREATE), "file creation properties"};
  constexpr unsigned kTracked = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
  check(H5Pset_link_creation_order(creation.get(), kTracked), "creation order");
  check(H5Pset_attr_creation_order(creation.get(), kTracked), "creation order");
  check(H5Pset_obj_track_times(creation.get(), false), "object times");
  // Made anew, never emptied: what a stop left may be a second name of a file that was published since.
  calls.unlink(path.c_str());
  return {H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation.get(), access.get()), "creating"};
}

void finish_file(FileHandle file) {
  check(H5Fflush(file.get(), H5F_SCOPE_GLOBAL), "flushing");
  file.close("closing");
  if (!unclosed().empty()) throw HdfError("closing a part: " + unclosed());
}

GroupHandle make_group(hid_t parent, const std::string& name, const std::string& nx_class) {
  const PropertyHandle properties{H5Pcreate(H5P_GROUP_CREATE), "group properties"};
  constexpr unsigned kTracked = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
  check(H5Pset_link_creation_order(properties.get(), kTracked), "creation order");
  check(H5Pset_attr_creation_order(properties.get(), kTracked), "creation order");
  check(H5Pset_obj_track_times(properties.get(), false), "object times");
  GroupHandle group{H5Gcreate2(parent, name.c_str(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                    "group " + name};
  write_attribute(group.get(), "NX_class", nx_class);
  return group;
}

void write_attribute(hid_t object, const std::string& name, std::string_view text) {
  const std::string terminated{text};
  const char* const value = terminated.c_str();
  const TypeHandle type = text_type(H5T_VARIABLE);
  const SpaceHandle space{H5Screate(H5S_SCALAR), "scalar space"};
  const AttributeHandle attribute = make_attribute(object, name, type.get(), space);
  check(H5Awrite(attribute.get(), type.get(), &value), "writing attribute " + name);
}

void write_attribute(hid_t object, const std::string& name, const std::vector<std::string>& texts) {
  std::vector<const char*> values;
  values.reserve(texts.size());
  for (const auto& text : texts) values.push_back(text.c_str());
  const TypeHandle type = text_type(H5T_VARIABLE);
  const AttributeHandle attribute = make_attribute(object, name, type.get(), column_space(values.size()));
  check(H5Awrite(attribute.get(), type.get(), values.data()), "writing attribute " + name);
}

template <typename T>
void write_number_attribute(hid_t object, const std::string& name, T value) {
  const SpaceHandle space{H5Screate(H5S_SCALAR), "scalar space"};
  const AttributeHandle attribute = make_attribute(object, name, NumberType<T>::file(), space);
  check(H5Awrite(attribute.get(), NumberType<T>::memory(), &value), "writing attribute " + name);
}

DatasetHandle write_text(hid_t parent, const std::string& name, std::string_view text) {
  std::string padded{text};
  if (padded.empty()) padded.push_back('\0');  // HDF5 knows no string of size 0.
  const TypeHandle type = text_type(padded.size());
  const SpaceHandle space{H5Screate(H5S_SCALAR), "scalar space"};
  DatasetHandle dataset = make_dataset(parent, name, type.get(), space, dataset_properties());
  check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), "writing " + name);
  return dataset;
}

template <typename T>
DatasetHandle write_scalar(hid_t parent, const FieldName& name, T value) {
  const std::string text{name.name};
  const SpaceHandle space{H5Screate(H5S_SCALAR), "scalar space"};
  DatasetHandle dataset = make_dataset(parent, text, NumberType<T>::file(), space, dataset_properties());
  check(H5Dwrite(dataset.get(), NumberType<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &value),
        "writing " + text);
  write_meaning(dataset, name);
  return dataset;
}

template <typename T>
DatasetHandle make_column(hid_t parent, const std::string& name, std::size_t count) {
  const hsize_t shape = count;
  const PropertyHandle properties = count == 0 ? dataset_properties() : compressed_properties({&shape, 1});
  return make_dataset(parent, name, NumberType<T>::file(), column_space(count), properties);
}

template <typename T>
ColumnWriter<T>::ColumnWriter(hid_t parent, const FieldName& name, std::size_t count)
    : name_(name.name), dataset_(make_column<T>(parent, name_, count)) {
  write_meaning(dataset_, name);
}

template <typename T>
void ColumnWriter<T>::append(std::span<const T> values) {
  const hsize_t count = values.size();
  const SpaceHandle file{H5Dget_space(dataset_.get()), "space of " + name_};
  check(H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, &row_, nullptr, &count, nullptr), "rows of " + name_);
  const SpaceHandle memory = column_space(values.size());
  check(
      H5Dwrite(dataset_.get(), NumberType<T>::memory(), memory.get(), file.get(), H5P_DEFAULT, values.data()),
      "writing " + name_);
  row_ += count;
}

template <typename T>
DatasetHandle write_array(hid_t parent, const FieldName& name, std::span<const hsize_t> shape,
                          std::span<const T> values) {
  const std::string text{name.name};
  DatasetHandle dataset = make_dataset(parent, text, NumberType<T>::file(), array_space(shape),
                                       values.empty() ? dataset_properties() : compressed_properties(shape));
  check(H5Dwrite(dataset.get(), NumberType<T>::memory(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
        "writing " + text);
  write_meaning(dataset, name);
  return dataset;
}

template <typename T>
DatasetHandle write_column(hid_t parent, const FieldName& name, std::span<const T> values) {
  const hsize_t count = values.size();
  return write_array(parent, name, {&count, 1}, values);
}

DatasetHandle write_text_array(hid_t parent, const std::string& name, std::span<const hsize_t> shape,
                               const std::vector<std::string_view>& texts) {
  std::size_t width = 1;
  for (const auto text : texts) width = std::max(width, text.size());
  std::string padded;
  padded.reserve(width * texts.size());
  for (const auto text : texts) padded.append(text).append(width - text.size(), '\0');
  const TypeHandle type = text_type(width);
  DatasetHandle dataset =
      make_dataset(parent, name, type.get(), array_space(shape), compressed_properties(shape));
  check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), "writing " + name);
  return dataset;
}

TextColumnWriter::TextColumnWriter(hid_t parent, const std::string& name, std::size_t width,
                                   std::size_t count)
    : name_(name),
      width_(width),
      type_(text_type(width)),
      dataset_(make_dataset(parent, name, type_.get(), column_space(count), dataset_properties())) {}

void TextColumnWriter::append(std::span<const std::string_view> texts) {
  std::string padded;
  padded.reserve(width_ * texts.size());
  for (const std::string_view text : texts) padded.append(text).append(width_ - text.size(), '\0');
  const hsize_t count = texts.size();
  const SpaceHandle file{H5Dget_space(dataset_.get()), "space of " + name_};
  check(H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, &row_, nullptr, &count, nullptr), "rows of " + name_);
  const SpaceHandle memory = column_space(texts.size());
  check(H5Dwrite(dataset_.get(), type_.get(), memory.get(), file.get(), H5P_DEFAULT, padded.data()),
        "writing " + name_);
  row_ += count;
}

DatasetHandle write_texts(hid_t parent, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t width = 1;
  for (const auto& text : texts) width = std::max(width, text.size());
  std::string padded;
  for (const auto& text : texts) padded.append(text).append(width - text.size(), '\0');
  const TypeHandle type = text_type(width);
  DatasetHandle dataset =
      make_dataset(parent, name, type.get(), column_space(texts.size()), dataset_properties());
  check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), "writing " + name);
  return dataset;
}

void attach_scale(const DatasetHandle& column, const DatasetHandle& scale, const std::string& name) {
  check(H5DSattach_scale(column.get(), scale.get(), 0), "dimension scale of " + name);
}

void TableWriter::attach(const DatasetHandle& column, const std::string& name) {
  if (scale_.empty()) {
    check(H5DSset_scale(column.get(), name.c_str()), "dimension scale " + name);
    check(H5Iinc_ref(column.get()), "reference to " + name);
    scale_.emplace_back(column.get(), name);
  } else {
    attach_scale(column, scale_.front(), name);
  }
}

#define STICKSLIP_INSTANTIATE(type)                                                     \
  template DatasetHandle write_scalar(hid_t, const FieldName&, type);                   \
  template DatasetHandle write_column(hid_t, const FieldName&, std::span<const type>);  \
  template DatasetHandle write_array(hid_t, const FieldName&, std::span<const hsize_t>, \
                                     std::span<const type>);                            \
  template class ColumnWriter<type>;                                                    \
  template void write_number_attribute(hid_t, const std::string&, type)
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
