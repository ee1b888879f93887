#include "daemon/new_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>

#include "core/record/file.hpp"

namespace stickslip::daemon {
namespace {

base::Result<void> write_whole(const std::filesystem::path& path, std::string_view text) {
  constexpr mode_t kEverybodyReads = 0644;
  const record::Descriptor file{
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kEverybodyReads)};
  if (!file.open()) {
    return base::failure("{}: cannot be made: {}", path.string(), record::system_message(errno));
  }
  while (!text.empty()) {
    const ssize_t written = ::write(file.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      return base::failure("{}: cannot be written: {}", path.string(), record::system_message(errno));
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return record::sync_path(path);
}

}  // namespace

base::Result<void> write_new_file(const std::filesystem::path& path, std::string_view text) {
  std::filesystem::path part = path;
  part += ".part";
  base::Result<void> done = write_whole(part, text);
  if (done) done = record::rename_to_new(part, path);
  if (!done) ::unlink(part.c_str());
  return done;
}

}  // namespace stickslip::daemon
