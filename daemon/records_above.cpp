#include "daemon/records_above.hpp"

#include <algorithm>
#include <regex>
#include <system_error>

#include "daemon/dated_folders.hpp"

namespace stickslip::daemon {
std::vector<std::filesystem::path> records_above(const std::filesystem::path& folder,
                                                 const std::string& newest, std::size_t most) {
  // As storage.cpp names them.
  static const std::regex own{R"(\d{8}T\d{6}Z-\d{4,}(-\d+)?\.h5)"};
  std::vector<std::filesystem::path> found;
  std::error_code error;
  const auto options = std::filesystem::directory_options::skip_permission_denied;
  for (std::filesystem::recursive_directory_iterator at{folder, options, error}, end; !error && at != end;
       at.increment(error)) {
    if (at.depth() >= kDeepestRecordFolder) at.disable_recursion_pending();
    const std::filesystem::path& path = at->path();
    if (path.stem().string() > newest && std::regex_match(path.filename().string(), own)) {
      found.push_back(path);
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.stem() < b.stem(); });
  if (found.size() > most) found.erase(found.begin(), found.end() - static_cast<std::ptrdiff_t>(most));
  return found;
}

}  // namespace stickslip::daemon
