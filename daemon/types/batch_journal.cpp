#include "daemon/types/batch_journal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <fstream>
#include <span>

#include "core/record/file.hpp"
#include "daemon/types/batch_json.hpp"

namespace stickslip::daemon {
namespace {

/// Folders between a record and its journal, at most: 2026/11/20261121T125252Z-0003.h5.
constexpr int kDatedLevels = 2;

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

BatchJournal::BatchJournal(const std::filesystem::path& folder, const record::FileCalls& calls)
    : path_(folder / kBatchJournal), calls_(calls) {}

base::Result<void> BatchJournal::append(const BatchEvent& event) const {
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
  const std::string line = fmt::format("{}{}\n", *torn ? "\n" : "", line_of(event));
  const auto bytes = std::as_bytes(std::span{line});
  if (record::write_all(file.get(), bytes, calls_) != bytes.size())
    return refused(record::system_message(errno));
  if (calls_.fdatasync(file.get()) != 0) return refused(record::system_message(errno));
  if (is_new) return record::sync_folder(record::folder_of(path_), calls_);
  return {};
}

base::Result<std::vector<std::string>> BatchJournal::read_on(BatchBook& book) {
  std::vector<std::string> remarks;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path_, error);
  if (error == std::errc::no_such_file_or_directory) return remarks;
  if (error) return base::failure("{}: cannot be read: {}", path_.string(), error.message());
  if (size < read_) {
    return base::failure("{}: is shorter than it was ({} bytes, was {}); it may only grow", path_.string(),
                         size, read_);
  }
  if (size == read_) return remarks;
  std::ifstream file{path_, std::ios::binary};
  file.seekg(static_cast<std::streamoff>(read_));
  for (std::string line; std::getline(file, line) && !file.eof();) {
    read_ += line.size() + 1;
    ++line_;
    if (line.empty()) continue;
    const base::Result<BatchEvent> event = event_of(line);
    if (event) {
      book.apply(*event);
    } else {
      remarks.push_back(fmt::format("{}: line {}: {}", path_.string(), line_, event.error().message));
    }
  }
  if (file.bad()) return base::failure("{}: cannot be read", path_.string());
  return remarks;
}

std::optional<std::filesystem::path> journal_folder_of(const std::filesystem::path& record) {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::weakly_canonical(record, error).parent_path();
  if (error) return std::nullopt;
  for (int level = 0; level <= kDatedLevels; ++level) {
    if (std::filesystem::exists(folder / kBatchJournal, error)) return folder;
    if (folder == folder.root_path()) break;
    folder = folder.parent_path();
  }
  return std::nullopt;
}

std::string name_in_journal(const std::filesystem::path& folder, const std::filesystem::path& record) {
  std::error_code error;
  const auto whole = std::filesystem::weakly_canonical(record, error);
  const auto base = std::filesystem::weakly_canonical(folder, error);
  return whole.lexically_relative(base).generic_string();
}

}  // namespace stickslip::daemon
