/// \file
/// Files with one bit that is not as it was, and where the data of an HDF5 file stand.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/record_samples.hpp"

namespace stickslip::test {

/// Bytes of a file.
struct Extent {
  std::string dataset;
  std::uint64_t first = 0;
  std::uint64_t size = 0;
};

/// The stored chunks of the data sets of one group, as HDF5 itself tells.
inline std::vector<Extent> chunks_of(const std::filesystem::path& path, const std::string& group,
                                     const std::vector<std::string>& names) {
  std::vector<Extent> extents;
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  for (const std::string& name : names) {
    const hid_t dataset = H5Dopen2(file, (std::filesystem::path{group} / name).c_str(), H5P_DEFAULT);
    if (dataset < 0) throw std::runtime_error("no data set " + name);
    const hid_t space = H5Dget_space(dataset);
    hsize_t count = 0;
    H5Dget_num_chunks(dataset, space, &count);
    for (hsize_t i = 0; i < count; ++i) {
      hsize_t first_row = 0;
      unsigned filters = 0;
      haddr_t address = 0;
      hsize_t size = 0;
      if (H5Dget_chunk_info(dataset, space, i, &first_row, &filters, &address, &size) < 0)
        throw std::runtime_error("no chunk of " + name);
      extents.push_back({name, address, size});
    }
    H5Sclose(space);
    H5Dclose(dataset);
  }
  H5Fclose(file);
  return extents;
}

/// The same file with the bit `bit` (of byte bit / 8) the other way.
inline void write_flipped(const std::filesystem::path& path, std::string content, std::uint64_t bit) {
  content[bit / 8] = static_cast<char>(static_cast<unsigned char>(content[bit / 8]) ^ (1U << (bit % 8)));
  write_content(path, content);
}

}  // namespace stickslip::test
