#include "daemon/control/record_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "daemon/control/reply.hpp"
#include "daemon/control/request_body.hpp"

namespace stickslip::daemon {

HttpReply record_reply(const std::string& name, std::span<const TestSummary> tests) {
  const auto test = std::find_if(tests.begin(), tests.end(), [&name](const TestSummary& one) {
    return !one.file.empty() && std::filesystem::path{one.file}.filename() == name;
  });
  if (test == tests.end())
    return refusal(404, fmt::format("no record of the latest tests is called {}", printable(name)));
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(test->file, error);
  if (error) return refusal(404, fmt::format("{}: {}", test->file, error.message()));
  if (size > kLargestServed) {
    return refusal(404, fmt::format("{} has {} MiB, more than {} are not sent: copy it from the disk",
                                    test->file, size >> 20U, kLargestServed >> 20U));
  }
  std::ifstream file{test->file, std::ios::binary};
  HttpReply reply{200, std::string{std::istreambuf_iterator<char>{file}, {}}, {}};
  if (reply.body.size() != size) return refusal(404, fmt::format("{} cannot be read", test->file));
  reply.content_type = "application/x-hdf5";
  return reply;
}

}  // namespace stickslip::daemon
