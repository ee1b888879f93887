#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <vector>

#include "core/record/hdf_read.hpp"
#include "core/record/judge.hpp"

namespace stickslip::record {
namespace {

/// Largest chunk read. This program writes smaller ones: 35 000 rows of numbers, or of texts of some hundred
/// bytes.
constexpr std::size_t kLargestChunk = std::size_t{1} << 28U;
constexpr int kMostDimensions = H5S_MAX_RANK;
/// Most chunks of one data set that are reported singly, since a file may claim any number.
constexpr int kMostNamed = 100;

struct Walk {
  Verdict* verdict;
  std::string error;  ///< What stopped the walk; empty if nothing did.
  bool is_out_of_memory;
};

/// Elements of a chunk or of a whole data set, within reason.
std::size_t bytes_of(const std::vector<hsize_t>& shape, std::size_t element, const std::string& name) {
  std::size_t bytes = element;
  for (const hsize_t side : shape) {
    if (side != 0 && bytes > kLargestChunk / side)
      throw HdfError(name + " is larger than any of this program");
    bytes *= side;
  }
  return bytes;
}

std::vector<hsize_t> shape_of(const SpaceHandle& space, const std::string& name) {
  const int dimensions = H5Sget_simple_extent_ndims(space.get());
  if (dimensions < 0 || dimensions > kMostDimensions) throw HdfError(name + " has no shape");
  std::vector<hsize_t> shape(static_cast<std::size_t>(dimensions));
  if (dimensions > 0)
    check(H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr), "shape of " + name);
  return shape;
}

/// Every chunk that the shape asks for has to be stored: HDF5 reads others as zeros, without a word.
void judge_chunked(const DatasetHandle& dataset, const std::string& name, const PropertyHandle& properties,
                   Verdict& verdict) {
  const SpaceHandle space{H5Dget_space(dataset.get()), "space of " + name};
  const TypeHandle type{H5Dget_type(dataset.get()), "type of " + name};
  const std::vector<hsize_t> shape = shape_of(space, name);
  std::vector<hsize_t> chunk(shape.size());
  check(H5Pget_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), "chunks of " + name);
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return;
  std::vector<std::byte> bytes(bytes_of(chunk, H5Tget_size(type.get()), name));
  int named = 0;
  std::vector<hsize_t> first(shape.size(), 0);
  for (;;) {
    std::vector<hsize_t> count(shape.size());
    for (std::size_t i = 0; i < shape.size(); ++i) count[i] = std::min(chunk[i], shape[i] - first[i]);
    const std::string place =
        fmt::format("{} rows {} to {}", name, first.front(), first.front() + count.front() - 1);
    unsigned filters = 0;
    haddr_t address = HADDR_UNDEF;
    hsize_t size = 0;
    if (H5Dget_chunk_info_by_coord(dataset.get(), first.data(), &filters, &address, &size) < 0 ||
        address == HADDR_UNDEF) {
      verdict.damage(place, "are not stored");
      ++named;
    } else {
      const SpaceHandle file{H5Scopy(space.get()), "space of " + name};
      check(H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, first.data(), nullptr, count.data(), nullptr),
            "rows of " + name);
      const SpaceHandle memory{H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                               "rows of " + name};
      if (H5Dread(dataset.get(), type.get(), memory.get(), file.get(), H5P_DEFAULT, bytes.data()) < 0) {
        verdict.damage(place, "cannot be read: wrong checksum or cut short");
        ++named;
      }
    }
    if (named == kMostNamed) return;
    std::size_t side = shape.size();
    while (side-- > 0) {
      first[side] += chunk[side];
      if (first[side] < shape[side]) break;
      first[side] = 0;
    }
    if (side == static_cast<std::size_t>(-1)) return;
  }
}

/// Nothing of other layouts has a place finer than the whole.
void judge_whole(const DatasetHandle& dataset, const std::string& name, Verdict& verdict) {
  const SpaceHandle space{H5Dget_space(dataset.get()), "space of " + name};
  const TypeHandle type{H5Dget_type(dataset.get()), "type of " + name};
  const std::size_t size = bytes_of(shape_of(space, name), H5Tget_size(type.get()), name);
  if (size == 0) return;
  std::vector<std::byte> bytes(size);
  if (H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    verdict.damage(name, "cannot be read: damaged or cut short");
}

void judge_dataset(hid_t file, const std::string& name, Verdict& verdict) {
  try {
    const DatasetHandle dataset = open_dataset(file, name);
    const TypeHandle type{H5Dget_type(dataset.get()), "type of " + name};
    if (H5Tget_class(type.get()) == H5T_VLEN || H5Tis_variable_str(type.get()) > 0) return;
    const PropertyHandle properties{H5Dget_create_plist(dataset.get()), "properties of " + name};
    if (H5Pget_layout(properties.get()) == H5D_CHUNKED) {
      judge_chunked(dataset, name, properties, verdict);
    } else {
      judge_whole(dataset, name, verdict);
    }
  } catch (const HdfError& error) {
    verdict.damage(name, error.what());
  }
}

/// For H5Ovisit: exceptions must not pass through the library.
herr_t visit(hid_t file, const char* name, const H5O_info_t* object, void* data) noexcept {
  auto& walk = *static_cast<Walk*>(data);
  try {
    if (object->type == H5O_TYPE_DATASET) judge_dataset(file, name, *walk.verdict);
    return 0;
  } catch (const std::bad_alloc&) {
    walk.is_out_of_memory = true;
  } catch (const std::exception& error) {
    walk.error = error.what();
  }
  return -1;
}

}  // namespace

void judge_chunks(hid_t file, Verdict& verdict) {
  Walk walk{&verdict, {}, false};
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, &walk, H5O_INFO_BASIC) >= 0) return;
  if (walk.is_out_of_memory) throw std::bad_alloc{};
  verdict.damage("file", walk.error.empty() ? "not every object in it can be opened" : walk.error);
}

}  // namespace stickslip::record
