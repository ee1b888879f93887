#include "daemon/types/line_journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <fstream>
#include <span>

#include "core/record/file.hpp"

namespace stickslip::daemon {
namespace {

/// True if the file ends inside a line.
base::Result<bool> ends_torn(int file) {
  const off_t end = ::lseek(file, 0, SEEK_END);
  if (end < 0) return base::failure("{}", record::system_message(errno));
  if (end == 0) return false;
  char last = '\n';
  if (::pread(file, &last, 1, end - 1) != 1) return base::failure("{}", record::system_message(errno));
  return last != '\n';
}

}  // namespace

base::Result<void> LineJournal::append(const std::vector<std::string>& lines) const {
  if (lines.empty()) return {};
  const auto refused = [this](const std::string& why) {
    return base::failure("{}: cannot be written: {}", path_.string(), why);
  };
  std::error_code ignored;
  const bool is_new = !std::filesystem::exists(path_, ignored);
  constexpr mode_t kGroupWrites = 0664;
  const record::Descriptor file{
      calls_.open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, kGroupWrites)};
  if (!file.open()) return refused(record::system_message(errno));
  // Given back when the file is closed.
  if (::flock(file.get(), LOCK_EX) != 0) return refused(record::system_message(errno));
  const base::Result<bool> torn = ends_torn(file.get());
  if (!torn) return refused(torn.error().message);
  const std::string text = fmt::format("{}{}\n", *torn ? "\n" : "", fmt::join(lines, "\n"));
  const auto bytes = std::as_bytes(std::span{text});
  if (record::write_all(file.get(), bytes, calls_) != bytes.size())
    return refused(record::system_message(errno));
  if (calls_.fdatasync(file.get()) != 0) return refused(record::system_message(errno));
  if (is_new) return record::sync_folder(record::folder_of(path_), calls_);
  return {};
}

base::Result<void> LineJournal::read_on(const std::function<void(std::string_view, std::int64_t)>& line) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path_, error);
  if (error == std::errc::no_such_file_or_directory) return {};
  if (error) return base::failure("{}: cannot be read: {}", path_.string(), error.message());
  if (size < read_) {
    return base::failure("{}: is shorter than it was ({} bytes, was {}); it may only grow", path_.string(),
                         size, read_);
  }
  if (size == read_) return {};
  std::ifstream file{path_, std::ios::binary};
  if (!file.is_open())
    return base::failure("{}: cannot be read: {}", path_.string(), record::system_message(errno));
  file.seekg(static_cast<std::streamoff>(read_));
  for (std::string text; std::getline(file, text) && !file.eof();) {
    read_ += text.size() + 1;
    ++line_;
    if (!text.empty()) line(text, line_);
  }
  if (file.bad()) return base::failure("{}: cannot be read", path_.string());
  return {};
}

}  // namespace stickslip::daemon
