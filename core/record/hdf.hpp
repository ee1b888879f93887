/// \file
/// RAII handles of HDF5, and checked calls. Within this folder errors are exceptions, HdfError; the public
/// functions convert them into values.
#pragma once

#include <hdf5.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace stickslip::record {

/// Error of HDF5, or content that is not of the format: one line without the file's name, which the public
/// functions add.
class HdfError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// \throws HdfError naming `what` and the library's innermost reason. If memory was exhausted, calls the
/// process's std::new_handler first.
[[noreturn]] void throw_refused(const std::string& what);

/// Reason of this thread's latest failure to close a handle in a destructor; empty if there was none since
/// create_file(). Closing a data set may write its last bytes: finish_file() fails if this is not empty.
[[nodiscard]] std::string& unclosed() noexcept;
/// Sets unclosed() to the library's innermost reason.
void note_unclosed() noexcept;

/// Owns an HDF5 id. Move-only; assignment swaps the ids. The destructor closes it; a failure goes to
/// unclosed().
/// \tparam Close  the library's function for its kind.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  /// \throws HdfError naming `what` if the library refused, i.e. id is negative.
  Handle(hid_t id, const std::string& what) : id_(id) {
    if (id < 0) throw_refused(what);
  }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() {
    if (id_ >= 0 && Close(id_) < 0) note_unclosed();
  }

  [[nodiscard]] hid_t get() const noexcept { return id_; }

  /// Closes now. \throws HdfError if that fails (buffers may be lost) or it holds no id.
  void close(const std::string& what) {
    if (Close(std::exchange(id_, -1)) < 0) throw_refused(what);
  }

 private:
  hid_t id_;
};

using FileHandle = Handle<H5Fclose>;
using GroupHandle = Handle<H5Gclose>;
using DatasetHandle = Handle<H5Dclose>;
using AttributeHandle = Handle<H5Aclose>;
using SpaceHandle = Handle<H5Sclose>;
using TypeHandle = Handle<H5Tclose>;
using PropertyHandle = Handle<H5Pclose>;

/// \throws HdfError naming `what` if an HDF5 status is negative.
inline void check(herr_t status, const std::string& what) {
  if (status < 0) throw_refused(what);
}

/// To be called in each thread before any other HDF5 function: switches off the library's exit handler, which
/// crashes after a full disk, and its printing of errors in this thread. create_file() and open_hdf5() call
/// it. \throws HdfError.
void prepare_hdf5();

/// Memory and file type of a C++ number. Files are little-endian.
template <typename T>
struct NumberType;
#define STICKSLIP_HDF5_NUMBER(type, memory_id, file_id) \
  template <>                                           \
  struct NumberType<type> {                             \
    static hid_t memory() { return memory_id; }         \
    static hid_t file() { return file_id; }             \
  }
STICKSLIP_HDF5_NUMBER(double, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
STICKSLIP_HDF5_NUMBER(float, H5T_NATIVE_FLOAT, H5T_IEEE_F32LE);
STICKSLIP_HDF5_NUMBER(std::int64_t, H5T_NATIVE_INT64, H5T_STD_I64LE);
STICKSLIP_HDF5_NUMBER(std::uint64_t, H5T_NATIVE_UINT64, H5T_STD_U64LE);
STICKSLIP_HDF5_NUMBER(std::int32_t, H5T_NATIVE_INT32, H5T_STD_I32LE);
STICKSLIP_HDF5_NUMBER(std::uint32_t, H5T_NATIVE_UINT32, H5T_STD_U32LE);
STICKSLIP_HDF5_NUMBER(std::uint16_t, H5T_NATIVE_UINT16, H5T_STD_U16LE);
STICKSLIP_HDF5_NUMBER(std::uint8_t, H5T_NATIVE_UINT8, H5T_STD_U8LE);
#undef STICKSLIP_HDF5_NUMBER

}  // namespace stickslip::record
