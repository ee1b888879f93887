// A record that somebody changed with HDF5's own tools in any way: other values, types, shapes, attributes,
// things missing or in each other's place. It is read or refused in one line, and judged. (Files whose HDF5
// structure is damaged are read in a process of their own: they may crash the library.
// tests/property/record_flips_test.cpp flips bits of them.)

#include <fuzzer/FuzzedDataProvider.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "core/base/contract.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "core/record/verdict.hpp"
#include "tests/support/record_samples.hpp"

namespace {

using namespace stickslip;

struct Object {
  std::string path;
  H5O_type_t type = H5O_TYPE_UNKNOWN;
};

struct Original {
  std::string bytes;
  std::vector<Object> objects;
};

herr_t note_object(hid_t, const char* name, const H5O_info_t* info, void* objects) {
  if (std::string_view{name} != ".")
    static_cast<std::vector<Object>*>(objects)->push_back({name, info->type});
  return 0;
}

Original make_original() {
  const test::TemporaryFolder folder;
  const auto published = record::publish_record(test::sample_record(), folder / "original.h5");
  STICKSLIP_EXPECTS(published);
  Original original{test::content_of(folder / "original.h5"), {}};
  const hid_t file = H5Fopen((folder / "original.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, note_object, &original.objects, H5O_INFO_BASIC);
  H5Fclose(file);
  STICKSLIP_EXPECTS(original.objects.size() > 100);
  return original;
}

/// Bytes for as many values as anything here has.
std::vector<char> values(FuzzedDataProvider& input) {
  constexpr std::size_t kMost = 1 << 16;
  std::vector<char> bytes(kMost);
  const std::string some = input.ConsumeRandomLengthString(64);
  for (std::size_t i = 0; i < kMost && !some.empty(); ++i) bytes[i] = some[i % some.size()];
  return bytes;
}

/// A number or a text of fixed or of any length; the caller closes it.
hid_t any_type(FuzzedDataProvider& input) {
  const std::array numbers{H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I64LE, H5T_STD_U64LE,
                           H5T_STD_I32LE,  H5T_STD_U16LE,  H5T_STD_U8LE,  H5T_STD_I8BE};
  const auto which = input.ConsumeIntegralInRange<std::size_t>(0, numbers.size());
  if (which < numbers.size()) return H5Tcopy(numbers[which]);
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, input.ConsumeIntegralInRange<std::size_t>(1, 200));
  return text;
}

hid_t any_space(FuzzedDataProvider& input) {
  const int rank = input.ConsumeIntegralInRange<int>(0, 3);
  if (rank == 0) return H5Screate(input.ConsumeBool() ? H5S_SCALAR : H5S_NULL);
  std::array<hsize_t, 3> size{};
  for (hsize_t& one : size) one = input.ConsumeIntegralInRange<hsize_t>(0, rank == 1 ? 100 : 5);
  return H5Screate_simple(rank, size.data(), nullptr);
}

void put_data_set(hid_t file, const std::string& path, FuzzedDataProvider& input) {
  const hid_t type = any_type(input);
  const hid_t space = any_space(input);
  const hid_t set = H5Dcreate2(file, path.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (set >= 0) {
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values(input).data());
    H5Dclose(set);
  }
  H5Sclose(space);
  H5Tclose(type);
}

void put_attribute(hid_t file, const std::string& path, FuzzedDataProvider& input) {
  static constexpr std::array kNames{"units",          "signal",  "axes",   "NX_class",
                                     "format_version", "default", "creator"};
  const char* const name = input.PickValueInArray(kNames);
  H5Adelete_by_name(file, path.c_str(), name, H5P_DEFAULT);
  const hid_t type = any_type(input);
  const hid_t space = any_space(input);
  const hid_t attribute =
      H5Acreate_by_name(file, path.c_str(), name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (attribute >= 0) {
    H5Awrite(attribute, type, values(input).data());
    H5Aclose(attribute);
  }
  H5Sclose(space);
  H5Tclose(type);
}

void overwrite(hid_t file, const std::string& path, FuzzedDataProvider& input) {
  const hid_t set = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
  if (set < 0) return;
  const hid_t type = H5Dget_type(set);
  const hid_t space = H5Dget_space(set);
  const std::vector<char> bytes = values(input);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
  if (H5Tis_variable_str(type) > 0) {
    const std::string text{bytes.data(), ::strnlen(bytes.data(), 64)};
    const std::vector<const char*> texts(std::max<std::size_t>(count, 1), text.c_str());
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data());
  } else if (count * H5Tget_size(type) <= bytes.size()) {
    H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  }
  H5Sclose(space);
  H5Tclose(type);
  H5Dclose(set);
}

void stretch(hid_t file, const std::string& path, FuzzedDataProvider& input) {
  const hid_t set = H5Dopen2(file, path.c_str(), H5P_DEFAULT);
  if (set < 0) return;
  const std::array<hsize_t, 2> size{input.ConsumeIntegralInRange<hsize_t>(0, 200), 2};
  H5Dset_extent(set, size.data());
  H5Dclose(set);
}

void change(hid_t file, const std::vector<Object>& objects, FuzzedDataProvider& input) {
  const Object& object = objects[input.ConsumeIntegralInRange<std::size_t>(0, objects.size() - 1)];
  const Object& other = objects[input.ConsumeIntegralInRange<std::size_t>(0, objects.size() - 1)];
  const char* const path = object.path.c_str();
  switch (input.ConsumeIntegralInRange<int>(0, 6)) {
    case 0:
      H5Ldelete(file, path, H5P_DEFAULT);
      break;
    case 1:
      H5Ldelete(file, path, H5P_DEFAULT);
      put_data_set(file, object.path, input);
      break;
    case 2:
      put_attribute(file, object.path, input);
      break;
    case 3:
      stretch(file, object.path, input);
      break;
    case 4:
      H5Ldelete(file, path, H5P_DEFAULT);
      H5Lcreate_hard(file, other.path.c_str(), file, path, H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 5: {
      H5Ldelete(file, path, H5P_DEFAULT);
      const hid_t group = H5Gcreate2(file, path, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
      if (group >= 0) H5Gclose(group);
      break;
    }
    default:
      overwrite(file, object.path, input);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Original original = make_original();
  static const test::TemporaryFolder folder;
  static const std::string name = folder / "record.h5";
  FuzzedDataProvider input{data, size};
  test::write_content(name, original.bytes);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // Most changes of changes are refused.
  const hid_t file = H5Fopen(name.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  STICKSLIP_EXPECTS(file >= 0);
  while (input.remaining_bytes() > 0) change(file, original.objects, input);
  STICKSLIP_EXPECTS(H5Fclose(file) >= 0);
  const auto record = record::read_record(name);
  STICKSLIP_EXPECTS(record || record.error().message.find('\n') == std::string::npos);
  STICKSLIP_EXPECTS(!record || (record->end && record->scan.size() == record->raw.size()));
  static_cast<void>(record::judge(name));
  return 0;
}
