#include "io/own_records.hpp"

#include <algorithm>
#include <regex>

#include "io/dated_folders.hpp"

namespace stickslip::io {

std::vector<std::filesystem::path> own_records(const std::filesystem::path& folder) {
  // As io/record_name.hpp names them, with the suffix of record::free_journal_path().
  static const std::regex own{R"(\d{8}T\d{6}Z-\d{4,}(-\d+)?\.h5)"};
  // recover_folder() reports folders that cannot be read.
  const std::vector<std::string> files = find_files(folder, [](std::string_view name) {
                                           return std::regex_match(name.begin(), name.end(), own);
                                         }).files;
  std::vector<std::filesystem::path> found{files.begin(), files.end()};
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.stem() < b.stem(); });
  return found;
}

void keep_last(std::vector<std::filesystem::path>& records, std::size_t most) {
  if (records.size() <= most) return;
  records.erase(records.begin(), records.end() - static_cast<std::ptrdiff_t>(most));
}

}  // namespace stickslip::io
