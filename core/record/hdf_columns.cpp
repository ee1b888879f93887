#include "core/record/hdf_columns.hpp"

#include <fmt/format.h>

#include <array>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/wording.hpp"
#include "core/record/given_file.hpp"
#include "core/record/hdf_driver.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {
namespace {

/// Of datasets of one file; the rest is not looked at.
constexpr std::size_t kMostDatasets = 10'000;
constexpr std::size_t kLongestUnit = 64;

/// A text of either kind that HDF5 knows; nothing for anything else.
std::optional<std::string> any_text(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const AttributeHandle attribute{H5Aopen(object, name, H5P_DEFAULT), "attribute"};
  const TypeHandle type{H5Aget_type(attribute.get()), "type of an attribute"};
  const SpaceHandle space{H5Aget_space(attribute.get()), "space of an attribute"};
  if (H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1)
    return std::nullopt;
  if (H5Tis_variable_str(type.get()) > 0) {
    char* value = nullptr;
    check(H5Aread(attribute.get(), type.get(), &value), "reading an attribute");
    const std::unique_ptr<char, herr_t (*)(void*)> owner{value, H5free_memory};
    return value == nullptr ? std::string{} : std::string{value}.substr(0, kLongestUnit);
  }
  const std::size_t size = H5Tget_size(type.get());
  if (size > kLongestUnit) return std::nullopt;
  std::string value(size, '\0');
  check(H5Aread(attribute.get(), type.get(), value.data()), "reading an attribute");
  value.resize(std::min(value.size(), value.find('\0')));
  return value;
}

std::string unit_of(hid_t dataset) {
  for (const char* name : {"units", "unit", "Units", "Unit"}) {
    if (auto text = any_text(dataset, name)) return *std::move(text);
  }
  return {};
}

bool is_elsewhere(hid_t dataset) {
  const PropertyHandle creation{H5Dget_create_plist(dataset), "creation properties"};
  return H5Pget_external_count(creation.get()) > 0 || H5Pget_layout(creation.get()) == H5D_VIRTUAL;
}

/// By the attributes of netCDF: what stands in the dataset is not in its unit.
std::string scaled_by(hid_t dataset) {
  for (const char* name : {"scale_factor", "add_offset"}) {
    if (H5Aexists(dataset, name) > 0) return std::string{"is scaled by "} + name;
  }
  return {};
}

/// What keeps numbers of this type from being a column; `single` for those of few digits.
void judge_type(hid_t type, NumberColumn& column) {
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      column.single = H5Tget_size(type) <= sizeof(float);
      return;
    case H5T_INTEGER:
      return;
    case H5T_STRING:
      column.why = "is text";
      return;
    case H5T_ENUM:
      column.why = "is an enumeration";
      return;
    case H5T_COMPOUND:
      column.why = "is a compound in a compound";
      return;
    default:
      column.why = "is not of numbers";
  }
}

std::string member_name(hid_t type, unsigned member) {
  char* name = H5Tget_member_name(type, member);
  const std::unique_ptr<char, herr_t (*)(void*)> owner{name, H5free_memory};
  return name == nullptr ? std::string{} : std::string{name};
}

/// As h5py and MATLAB write complex numbers.
bool is_complex(hid_t type) {
  if (H5Tget_nmembers(type) != 2) return false;
  const std::string first = member_name(type, 0);
  const std::string second = member_name(type, 1);
  return (first == "r" && second == "i") || (first == "real" && second == "imag");
}

std::vector<std::uint64_t> axes_of(hid_t dataset) {
  const SpaceHandle space{H5Dget_space(dataset), "space of a dataset"};
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) throw HdfError("a dataset without a shape");
  if (H5Sget_simple_extent_type(space.get()) == H5S_NULL) return {0};
  std::vector<hsize_t> axes(static_cast<std::size_t>(rank));
  if (rank > 0 && H5Sget_simple_extent_dims(space.get(), axes.data(), nullptr) < 0)
    throw HdfError("a dataset without a shape");
  return {axes.begin(), axes.end()};
}

void add_dataset(hid_t file, const std::string& path, std::vector<NumberColumn>& columns) {
  NumberColumn column;
  column.path = path;
  try {
    const DatasetHandle dataset{H5Dopen2(file, path.c_str(), H5P_DEFAULT), path};
    const TypeHandle type{H5Dget_type(dataset.get()), path};
    const std::vector<std::uint64_t> axes = axes_of(dataset.get());
    column.unit = unit_of(dataset.get());
    column.why = is_elsewhere(dataset.get()) ? "lies in another file" : scaled_by(dataset.get());
    if (column.why.empty() && H5Tget_class(type.get()) == H5T_COMPOUND) {
      if (!is_complex(type.get())) {
        const int count = H5Tget_nmembers(type.get());
        for (int i = 0; i < count; ++i) {
          NumberColumn member;
          const auto index = static_cast<unsigned>(i);
          member.dataset = path;
          member.path = path + "." + member_name(type.get(), index);
          const TypeHandle own{H5Tget_member_type(type.get(), index), member.path};
          judge_type(own.get(), member);
          if (member.why.empty()) {
            add_parts(std::move(member), axes, columns);
          } else {
            columns.push_back(std::move(member));
          }
        }
        return;
      }
      column.why = "is complex";
    }
    if (column.why.empty()) judge_type(type.get(), column);
    if (column.why.empty()) {
      add_parts(std::move(column), axes, columns);
      return;
    }
  } catch (const HdfError&) {
    column.why = "is damaged";
  }
  columns.push_back(std::move(column));
}

herr_t note_dataset(hid_t /*group*/, const char* name, const H5O_info_t* info, void* paths) {
  auto& found = *static_cast<std::vector<std::string>*>(paths);
  if (info->type == H5O_TYPE_DATASET) found.push_back(std::string{"/"} + name);
  return found.size() < kMostDatasets ? 0 : 1;
}

/// The numbers of one member of a compound, or of the whole type.
TypeHandle memory_type(hid_t type, const std::string& member) {
  TypeHandle number{H5Tcopy(H5T_NATIVE_DOUBLE), "type of numbers"};
  if (H5Tget_class(type) != H5T_COMPOUND) return number;
  TypeHandle compound{H5Tcreate(H5T_COMPOUND, sizeof(double)), "type of a member"};
  check(H5Tinsert(compound.get(), member.c_str(), 0, number.get()), member);
  return compound;
}

}  // namespace

struct HdfColumns::Opened {
  GivenFile given;
  FileHandle file;
  std::vector<NumberColumn> columns;
  bool is_record = false;
};

HdfColumns::HdfColumns(std::unique_ptr<Opened> opened) : opened_(std::move(opened)) {}
HdfColumns::HdfColumns(HdfColumns&&) noexcept = default;
HdfColumns& HdfColumns::operator=(HdfColumns&&) noexcept = default;
HdfColumns::~HdfColumns() = default;

const std::vector<NumberColumn>& HdfColumns::columns() const noexcept { return opened_->columns; }

bool HdfColumns::is_record() const { return opened_->is_record; }

base::Result<HdfColumns> HdfColumns::open(const std::filesystem::path& path) {
  auto given = open_shared(path);
  if (!given) return tl::unexpected(given.error());
  try {
    // The descriptor is read. HDF5 resolves the name, which a pipe's copy in memory has none of.
    FileHandle file = open_hdf5(*given, "/dev/null");
    std::vector<std::string> paths;
    if (H5Ovisit(file.get(), H5_INDEX_NAME, H5_ITER_INC, note_dataset, &paths) < 0)
      throw HdfError("the names of its datasets cannot be read");
    auto opened = std::make_unique<Opened>(Opened{*std::move(given), std::move(file), {}});
    opened->is_record = any_text(opened->file.get(), "format") == std::string{kFormat};
    for (const std::string& dataset : paths) add_dataset(opened->file.get(), dataset, opened->columns);
    return HdfColumns{std::move(opened)};
  } catch (const std::exception& error) {
    return base::usage_error("is an HDF5 file but cut short or damaged ({}): take it from a backup",
                             base::reason_of(error));
  }
}

base::Result<std::vector<double>> HdfColumns::read(const NumberColumn& column) const {
  try {
    // No other dataset may be opened than the one that add_dataset() judged; its name may have points.
    const bool is_member = !column.dataset.empty();
    const std::string& path = is_member ? column.dataset : column.path;
    const std::string member = is_member ? column.path.substr(path.size() + 1) : std::string{};
    const DatasetHandle dataset{H5Dopen2(opened_->file.get(), path.c_str(), H5P_DEFAULT), path};
    const TypeHandle type{H5Dget_type(dataset.get()), path};
    const TypeHandle memory = memory_type(type.get(), member);
    const std::vector<std::uint64_t> axes = axes_of(dataset.get());
    NumberColumn judged;
    const ArrayShape shape = shape_of(axes, judged);
    if (!judged.why.empty() || part_number(column) >= shape.count) throw HdfError("no column " + column.path);
    std::vector<hsize_t> first(axes.size(), 0);
    std::vector<hsize_t> count(axes.size(), 1);
    if (shape.count > 1) first[shape.short_axis] = part_number(column);
    count[shape.long_axis] = shape.size;
    const SpaceHandle space{H5Dget_space(dataset.get()), path};
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
          path);
    const std::array<hsize_t, 1> size{shape.size};
    const SpaceHandle row{H5Screate_simple(1, size.data(), nullptr), path};
    std::vector<double> values(shape.size);
    check(H5Dread(dataset.get(), memory.get(), row.get(), space.get(), H5P_DEFAULT, values.data()), path);
    return values;
  } catch (const std::exception& error) {
    return base::usage_error("{}{} cannot be read ({}): the file is damaged; take it from a backup",
                             column.path, column.part, base::reason_of(error));
  }
}

}  // namespace stickslip::record
