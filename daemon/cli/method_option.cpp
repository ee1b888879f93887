#include "daemon/cli/method_option.hpp"

#include "core/friction/method_file.hpp"
#include "daemon/library.hpp"

namespace stickslip::daemon {

base::Result<friction::Method> chosen_method(const std::string& given) {
  if (given.empty()) return friction::Method{};
  const base::Result<std::filesystem::path> file = find_in(kMethods, given, {});
  if (!file) return base::usage_error("--method {}", file.error().message);
  base::Result<friction::MethodFile> method = friction::load_method(*file);
  if (!method) return tl::unexpected(method.error());
  return std::move(method->method);
}

}  // namespace stickslip::daemon
