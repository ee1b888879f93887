#include "core/record/seal.hpp"

#include <fcntl.h>
#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <vector>

#include "core/record/file.hpp"
#include "core/record/hdf_driver.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kSealName = "file_sha256";
constexpr std::size_t kSealSize = 64;  ///< SHA-256 in hexadecimal.
constexpr std::size_t kBlock = std::size_t{1} << 20U;

/// Bytes of the file before the characters of the seal.
std::uint64_t seal_position(hid_t process) {
  const DatasetHandle seal = open_dataset(process, kSealName);
  const haddr_t position = H5Dget_offset(seal.get());
  if (position == HADDR_UNDEF || H5Dget_storage_size(seal.get()) != kSealSize) {
    throw HdfError("process/file_sha256 has no 64 characters");
  }
  return position;
}

/// Of the file, the seal's characters taken as zero bytes.
std::string digest_of(const GivenFile& file, std::uint64_t position) {
  Sha256 sha;
  std::vector<std::byte> block(kBlock);
  for (std::uint64_t at = 0;;) {
    const ssize_t got = file.read(block, at);
    if (got < 0) throw HdfError("cannot be read: " + system_message(errno));
    if (got == 0) return sha.hexadecimal();
    const std::uint64_t end = at + static_cast<std::uint64_t>(got);
    const std::uint64_t from = std::clamp(position, at, end);
    const std::uint64_t to = std::clamp(position + kSealSize, at, end);
    std::fill(block.begin() + static_cast<std::ptrdiff_t>(from - at),
              block.begin() + static_cast<std::ptrdiff_t>(to - at), std::byte{0});
    sha.add(std::span<const std::byte>{block.data(), static_cast<std::size_t>(got)});
    at = end;
  }
}

}  // namespace

void write_seal(hid_t entry, std::size_t scan_count) {
  const GroupHandle process = open_group(entry, "process");
  write_scalar(process.get(), {"scan_count", "1", "number of scans committed [1]"},
               static_cast<std::int64_t>(scan_count));
  write_text(process.get(), kSealName, std::string(kSealSize, '\0'));
}

base::Result<void> seal_file(const std::filesystem::path& path, const FileCalls& calls) {
  try {
    std::uint64_t position = 0;
    const auto given = open_shared(path, calls);
    if (!given) return base::failure("{}: cannot be sealed: {}", path.string(), given.error().message);
    {
      const FileHandle file = open_hdf5(*given, path);
      const GroupHandle entry = open_group(file.get(), "entry");
      position = seal_position(open_group(entry.get(), "process").get());
    }
    const std::string digest = digest_of(*given, position);
    const Descriptor file{calls.open(path.c_str(), O_WRONLY | O_CLOEXEC, 0)};
    if (!file.open() ||
        calls.pwrite(file.get(), digest.data(), digest.size(), static_cast<off_t>(position)) !=
            static_cast<ssize_t>(digest.size()) ||
        calls.fsync(file.get()) != 0) {
      return base::failure("{}: cannot be sealed: {}", path.string(), system_message(errno));
    }
    return {};
  } catch (const std::exception& error) {
    return base::failure("{}: cannot be sealed: {}", path.string(), error.what());
  }
}

Seal check_seal(hid_t entry, const GivenFile& file) {
  const GroupHandle process = open_group(entry, "process");
  if (!has(process.get(), kSealName)) return Seal::kNone;
  const std::string stored = read_text(process.get(), kSealName);
  if (stored.empty()) return Seal::kOpen;
  return digest_of(file, seal_position(process.get())) == stored ? Seal::kSound : Seal::kBroken;
}

}  // namespace stickslip::record
