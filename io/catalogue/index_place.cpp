#include "io/catalogue/index_place.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <span>
#include <string>
#include <system_error>

#include "core/base/wording.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::catalogue {

base::Result<std::filesystem::path> index_place(const std::filesystem::path& folder) {
  const auto absolute = [](const char* name) {
    const char* const value = std::getenv(name);
    const std::filesystem::path path{value == nullptr ? "" : value};
    return path.is_absolute() ? path : std::filesystem::path{};  // As the XDG specification has it.
  };
  std::filesystem::path cache = absolute("XDG_CACHE_HOME");
  if (cache.empty() && !absolute("HOME").empty()) cache = absolute("HOME") / ".cache";
  if (cache.empty()) return base::failure("neither XDG_CACHE_HOME nor HOME names a folder");
  std::error_code error;
  std::filesystem::create_directories(cache, error);
  const std::filesystem::path own = cache / "stickslip";
  constexpr mode_t kOwnerAlone = 0700;
  if (!error && ::mkdir(own.c_str(), kOwnerAlone) != 0 && errno != EEXIST)
    error = {errno, std::generic_category()};
  if (!error && ::access(own.c_str(), W_OK | X_OK) != 0) error = {errno, std::generic_category()};
  if (error) return base::failure("{}: {}", own.string(), error.message());
  record::Sha256 hash;
  hash.add(std::span{folder.native()});
  constexpr std::size_t kDigits = 16;
  return own / fmt::format("catalogue-{}.sqlite", hash.hexadecimal().substr(0, kDigits));
}

}  // namespace stickslip::catalogue
