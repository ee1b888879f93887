#include "daemon/own_records.hpp"

#include <algorithm>
#include <regex>
#include <system_error>

#include "daemon/dated_folders.hpp"

namespace stickslip::daemon {

std::vector<std::filesystem::path> own_records(const std::filesystem::path& folder) {
  // As storage.cpp names them.
  static const std::regex own{R"(\d{8}T\d{6}Z-\d{4,}(-\d+)?\.h5)"};
  std::vector<std::filesystem::path> found;
  std::error_code error;
  const auto options = std::filesystem::directory_options::skip_permission_denied;
  for (std::filesystem::recursive_directory_iterator at{folder, options, error}, end; !error && at != end;
       at.increment(error)) {
    if (at.depth() >= kDeepestRecordFolder) at.disable_recursion_pending();
    if (std::regex_match(at->path().filename().string(), own)) found.push_back(at->path());
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.stem() < b.stem(); });
  return found;
}

void keep_last(std::vector<std::filesystem::path>& records, std::size_t most) {
  if (records.size() <= most) return;
  records.erase(records.begin(), records.end() - static_cast<std::ptrdiff_t>(most));
}

}  // namespace stickslip::daemon
