#include "io/new_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <span>

#include "core/record/file.hpp"
#include "core/record/record.hpp"

namespace stickslip::io {
namespace {

base::Result<void> write_whole(const std::filesystem::path& part, std::string_view text, mode_t mode) {
  const record::Descriptor file{
      ::open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode)};
  if (!file.open()) {
    return base::failure("{}: cannot be made: {}", part.string(), record::system_message(errno));
  }
  base::Result<void> done;
  if (record::write_all(file.get(), std::as_bytes(std::span{text}), record::system_calls()) != text.size()) {
    done = base::failure("{}: cannot be written: {}", part.string(), record::system_message(errno));
  } else if (::fsync(file.get()) != 0) {
    done = base::failure("{}: cannot be made durable: {}", part.string(), record::system_message(errno));
  }
  if (!done) ::unlink(part.c_str());
  return done;
}

}  // namespace

base::Result<void> write_new_file(const std::filesystem::path& path, std::string_view text, mode_t mode) {
  std::filesystem::path part = path;
  part += '.' + record::make_uuid() + ".part";
  if (auto written = write_whole(part, text, mode); !written) return written;
  auto named = record::rename_to_new(part, path);
  if (!named) ::unlink(part.c_str());
  return named;
}

}  // namespace stickslip::io
