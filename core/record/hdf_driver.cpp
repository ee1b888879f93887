#include "core/record/hdf_driver.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>

#include "core/record/file.hpp"

// A driver of HDF5 1.10 ["HDF5 Virtual File Layer", The HDF Group]: callbacks in C, no exception may leave
// them.

namespace stickslip::record {
namespace {

/// What the access properties carry.
struct Info {
  const FileCalls* calls;
  std::optional<GivenFile> given;  ///< To be read, instead of what the name leads to.
};

/// HDF5 knows only the first member.
struct File {
  H5FD_t base;
  const FileCalls* calls;
  int descriptor;
  std::optional<GivenFile> given;  ///< Owner of the descriptor, if the file is only read.
  haddr_t allocated;               ///< As far as HDF5 has given addresses away.
  haddr_t size;
};

// HDF5 hands over the base, the first member of a File, as its C interface has it.
File& file_of(H5FD_t* base) { return *reinterpret_cast<File*>(base); }
const File& file_of(const H5FD_t* base) { return *reinterpret_cast<const File*>(base); }

/// Onto HDF5's stack of errors, from where HdfError takes it.
herr_t refuse(const char* what, int error) noexcept {
  H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_VFL, H5E_WRITEERROR, "%s: %s", what,
           std::strerror(error));
  return -1;
}

void* copy_info(const void* info) { return new (std::nothrow) Info(*static_cast<const Info*>(info)); }
herr_t free_info(void* info) {
  delete static_cast<Info*>(info);
  return 0;
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t access, haddr_t /*largest*/) {
  const auto* info = static_cast<const Info*>(H5Pget_driver_info(access));
  if (info == nullptr) return nullptr;
  if (info->given) {
    if ((flags & H5F_ACC_RDWR) != 0) return nullptr;
    return reinterpret_cast<H5FD_t*>(new (std::nothrow) File{
        {}, info->calls, info->given->descriptor(), info->given, 0, info->given->size()});
  }
  int how = O_CLOEXEC | ((flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY);
  if ((flags & H5F_ACC_TRUNC) != 0) how |= O_TRUNC;
  if ((flags & H5F_ACC_CREAT) != 0) how |= O_CREAT;
  if ((flags & H5F_ACC_EXCL) != 0) how |= O_EXCL;
  constexpr mode_t kMode = 0644;
  const int descriptor = info->calls->open(name, how, kMode);
  if (descriptor < 0) {
    refuse("open", errno);
    return nullptr;
  }
  struct stat found {};
  if (::fstat(descriptor, &found) != 0) {
    refuse("fstat", errno);
    ::close(descriptor);
    return nullptr;
  }
  // HDF5 fills in the base itself.
  auto* file = new (std::nothrow)
      File{{}, info->calls, descriptor, std::nullopt, 0, static_cast<haddr_t>(found.st_size)};
  if (file == nullptr) ::close(descriptor);
  return reinterpret_cast<H5FD_t*>(file);
}

herr_t close_file(H5FD_t* base) {
  const std::unique_ptr<File> file{&file_of(base)};
  if (file->given) return 0;
  const int synced = file->calls->fsync(file->descriptor);
  const int error = errno;
  ::close(file->descriptor);
  return synced == 0 ? 0 : refuse("fsync", error);
}

int compare(const H5FD_t* a, const H5FD_t* b) {
  struct stat first {};
  struct stat second {};
  if (::fstat(file_of(a).descriptor, &first) != 0 || ::fstat(file_of(b).descriptor, &second) != 0)
    return a < b ? -1 : 1;
  if (first.st_dev != second.st_dev) return first.st_dev < second.st_dev ? -1 : 1;
  if (first.st_ino != second.st_ino) return first.st_ino < second.st_ino ? -1 : 1;
  return 0;
}

/// As the library's own driver for files: metadata gathered, small data too.
herr_t query(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA | H5FD_FEAT_POSIX_COMPAT_HANDLE | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

haddr_t allocated(const H5FD_t* file, H5FD_mem_t /*type*/) { return file_of(file).allocated; }
herr_t allocate(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t end) {
  file_of(file).allocated = end;
  return 0;
}
haddr_t size_of(const H5FD_t* file, H5FD_mem_t /*type*/) { return file_of(file).size; }

herr_t handle_of(H5FD_t* file, hid_t /*access*/, void** handle) {
  *handle = &file_of(file).descriptor;
  return 0;
}

herr_t read_at(H5FD_t* base, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, std::size_t size,
               void* bytes) {
  auto* to = static_cast<std::byte*>(bytes);
  const File& file = file_of(base);
  // A damaged file may ask for any place; that is no refusal of the system's.
  if (address > file.allocated || size > file.allocated - address) return refuse("read", EINVAL);
  while (size > 0) {
    const ssize_t got = file.given
                            ? file.given->read({to, size}, address)
                            : file.calls->pread(file.descriptor, to, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return refuse("read", errno);
    if (got == 0) {  // Behind the end of the file stand zeros.
      std::memset(to, 0, size);
      return 0;
    }
    to += got;
    address += static_cast<haddr_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  return 0;
}

herr_t write_at(H5FD_t* base, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, std::size_t size,
                const void* bytes) {
  File& file = file_of(base);
  const auto* from = static_cast<const std::byte*>(bytes);
  while (size > 0) {
    const ssize_t done = file.calls->pwrite(file.descriptor, from, size, static_cast<off_t>(address));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return refuse("write", done < 0 ? errno : EIO);
    from += done;
    address += static_cast<haddr_t>(done);
    size -= static_cast<std::size_t>(done);
  }
  file.size = std::max(file.size, address);
  return 0;
}

herr_t truncate_file(H5FD_t* base, hid_t /*transfer*/, hbool_t /*closing*/) {
  File& file = file_of(base);
  if (file.allocated == file.size) return 0;
  if (file.calls->ftruncate(file.descriptor, static_cast<off_t>(file.allocated)) != 0)
    return refuse("truncate", errno);
  file.size = file.allocated;
  return 0;
}

H5FD_class_t make_driver() {
  H5FD_class_t driver{};
  driver.name = "stickslip";
  driver.maxaddr = static_cast<haddr_t>(std::numeric_limits<off_t>::max());
  driver.fc_degree = H5F_CLOSE_SEMI;
  driver.fapl_size = sizeof(Info);
  driver.fapl_copy = copy_info;
  driver.fapl_free = free_info;
  driver.open = open_file;
  driver.close = close_file;
  driver.cmp = compare;
  driver.query = query;
  driver.get_eoa = allocated;
  driver.set_eoa = allocate;
  driver.get_eof = size_of;
  driver.get_handle = handle_of;
  driver.read = read_at;
  driver.write = write_at;
  driver.truncate = truncate_file;
  // As H5FD_FLMAP_DICHOTOMY: raw data apart from metadata.
  constexpr std::array<H5FD_mem_t, H5FD_MEM_NTYPES> kKinds = H5FD_FLMAP_DICHOTOMY;
  std::copy(kKinds.begin(), kKinds.end(), driver.fl_map);
  return driver;
}

void use_driver(const PropertyHandle& access, const Info& info) {
  static const H5FD_class_t driver = make_driver();
  static const hid_t id = H5FDregister(&driver);
  check(H5Pset_driver(access.get(), id, &info), "driver of files");
}

}  // namespace

void write_through(const PropertyHandle& access, const FileCalls& calls) {
  use_driver(access, {&calls, std::nullopt});
}

bool is_hdf5(const GivenFile& file) {
  // ["HDF5 File Format Specification", II.A]
  constexpr std::array<unsigned char, 8> kSignature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
  constexpr std::uint64_t kSecondPlace = 512;
  std::array<std::byte, kSignature.size()> found{};
  for (std::uint64_t at = 0; at + found.size() <= file.size(); at = at == 0 ? kSecondPlace : 2 * at) {
    if (file.read(found, at) == static_cast<ssize_t>(found.size()) &&
        std::memcmp(found.data(), kSignature.data(), found.size()) == 0) {
      return true;
    }
  }
  return false;
}

FileHandle open_hdf5(const GivenFile& file, const std::filesystem::path& path) {
  prepare_hdf5();
  const PropertyHandle access{H5Pcreate(H5P_FILE_ACCESS), "file access properties"};
  use_driver(access, {&system_calls(), file});
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), "opening"};
}

}  // namespace stickslip::record
