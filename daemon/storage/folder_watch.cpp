#include "daemon/storage/folder_watch.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/record/file.hpp"

namespace stickslip::storage {

FolderWatch::FolderWatch(std::filesystem::path folder, const record::FileCalls& calls)
    : folder_(std::move(folder)), calls_(calls), devices_(devices()) {}

std::vector<dev_t> FolderWatch::devices() const {
  // "/." follows a link and waits for a file system that is mounted when it is asked for.
  const auto look_at = [this](const std::filesystem::path& path, struct stat& found) {
    return calls_.lstat((path / ".").c_str(), &found) == 0;
  };
  struct stat here {};
  std::filesystem::path folder = folder_;
  while (!look_at(folder, here)) {
    if (errno != ENOENT || folder == ".") return {};
    folder = folder == folder.root_path() ? "." : record::folder_of(folder);
  }
  std::vector<dev_t> devices{here.st_dev};
  for (struct stat above{}; look_at(folder /= "..", above); here = above) {
    if (above.st_dev == here.st_dev && above.st_ino == here.st_ino) break;  // The root.
    if (above.st_dev != here.st_dev) devices.push_back(above.st_dev);
  }
  return devices;
}

std::optional<FolderWatch::Away> FolderWatch::look() {
  std::vector<dev_t> now = devices();
  if (now.empty()) {
    return Away{
        fmt::format("{}: cannot be looked at: {}", folder_.string(), record::system_message(errno)),
        fmt::format("see to it that {} is a folder that the daemon may read and write", folder_.string())};
  }
  if (devices_.empty() || now.front() == devices_.front()) {
    // The way up may end early, as when the file system goes meanwhile: what is above it stays known.
    if (now.size() >= devices_.size()) devices_ = std::move(now);
    return std::nullopt;
  }
  if (std::find(devices_.begin() + 1, devices_.end(), now.front()) != devices_.end()) {
    return Away{fmt::format("{}: its file system is not mounted any more", folder_.string()),
                fmt::format("mount the file system of {} again", folder_.string())};
  }
  devices_ = std::move(now);  // Another one is mounted there, or the same once more.
  return std::nullopt;
}

}  // namespace stickslip::storage
