#include "daemon/control/token.hpp"

#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "io/new_file.hpp"

#include "core/base/regular_file.hpp"

namespace stickslip::control {
namespace {

/// Bytes of a new token: 256 bits cannot be guessed.
constexpr std::size_t kBytes = 32;
constexpr std::size_t kShortest = 32;  ///< Of a token written by hand, characters.
constexpr std::size_t kLongest = 256;
constexpr std::size_t kMostOfFile = 2 * kLongest;

/// Not inlined: GCC 12 would warn wrongly that the text overflows the string's internal buffer.
[[gnu::noinline]] bool could_be_token(std::string_view text) {
  return text.size() >= kShortest && text.size() <= kLongest &&
         std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
         });
}

std::string because() { return std::generic_category().message(errno); }

base::Result<std::string> make_token(const std::filesystem::path& file) {
  std::array<unsigned char, kBytes> random{};
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    return base::failure("token file {}: no random numbers: {}", file.string(), because());
  }
  const std::string token = fmt::format("{:02x}", fmt::join(random, ""));
  constexpr mode_t kTokenMode = 0640;
  if (auto written = io::write_new_file(file, token + '\n', kTokenMode); !written)
    return base::failure("token file {}", written.error().message);
  return token;
}

}  // namespace

base::Result<std::string> load_token(const std::filesystem::path& file) {
  struct stat facts {};
  if (::stat(file.c_str(), &facts) != 0) {
    if (errno == ENOENT) return make_token(file);
    return base::failure("token file {}: cannot be read: {}", file.string(), because());
  }
  if ((facts.st_mode & (S_IROTH | S_IWOTH)) != 0) {
    return base::usage_error("token file {}: everybody may read or write it; chmod o-rw it", file.string());
  }
  const base::Result<std::string> text = base::read_text(file, kMostOfFile);
  if (!text) return tl::unexpected(base::Error{text.error().kind, "token file " + text.error().message});
  const std::string token = text->substr(0, text->find('\n'));
  if (!could_be_token(token)) {
    return base::usage_error(
        "token file {}: must hold one line of {} to {} letters and digits; remove it, and a new one is made",
        file.string(), kShortest, kLongest);
  }
  return token;
}

}  // namespace stickslip::control
