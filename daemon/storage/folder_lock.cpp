#include "daemon/storage/folder_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

namespace stickslip::storage {
namespace {

/// The holder of a lock as " (process 1234)", from /proc/locks [proc(5)]; empty if it is not listed, such as
/// in a container.
std::string owner_of(int folder) {
  struct stat facts {};
  if (::fstat(folder, &facts) != 0) return {};
  const std::string file =
      fmt::format("{:02x}:{:02x}:{}", major(facts.st_dev), minor(facts.st_dev), facts.st_ino);
  std::ifstream locks{"/proc/locks"};
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words{line};
    std::string number, kind, strength, access, process, locked;
    words >> number >> kind >> strength >> access >> process >> locked;
    if (kind == "FLOCK" && locked == file && process.find_first_not_of("0123456789") == std::string::npos &&
        process != "0")
      return fmt::format(" (process {})", process);
  }
  return {};
}

}  // namespace

base::Result<FolderLock> FolderLock::take(const std::filesystem::path& folder,
                                          const record::FileCalls& calls) {
  record::Descriptor opened{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (!opened.open())
    return base::failure("record folder {}: cannot be opened: {}", folder.string(),
                         record::system_message(errno));
  if (calls.flock(opened.get(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
    return FolderLock{std::move(opened)};
  return base::failure(
      "record folder {}: another stickslipd{} records into it: stop that one, or give this one a folder of "
      "its "
      "own in [record] folder",
      folder.string(), owner_of(opened.get()));
}

}  // namespace stickslip::storage
