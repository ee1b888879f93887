#include "daemon/control/record_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "daemon/control/request_body.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {

daemon::HttpReply record_reply(const std::string& name, std::span<const daemon::TestSummary> tests) {
  const auto test = std::find_if(tests.begin(), tests.end(), [&name](const daemon::TestSummary& one) {
    return !one.file.empty() && std::filesystem::path{one.file}.filename() == name;
  });
  if (test == tests.end())
    return daemon::refusal(404, fmt::format("no record of the latest tests is called {}", printable(name)));
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(test->file, error);
  if (error) return daemon::refusal(404, fmt::format("{}: {}", test->file, error.message()));
  if (size > kLargestServed) {
    return daemon::refusal(404, fmt::format("{} has {} MiB, more than {} are not sent: copy it from the disk",
                                            test->file, size >> 20U, kLargestServed >> 20U));
  }
  std::ifstream file{test->file, std::ios::binary};
  daemon::HttpReply reply{200, std::string{std::istreambuf_iterator<char>{file}, {}}, {}};
  if (reply.body.size() != size) return daemon::refusal(404, fmt::format("{} cannot be read", test->file));
  reply.content_type = "application/x-hdf5";
  return reply;
}

}  // namespace stickslip::control
