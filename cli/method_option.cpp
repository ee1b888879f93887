#include "cli/method_option.hpp"

#include "io/library.hpp"
#include "io/method_file.hpp"

namespace stickslip::cli {

base::Result<model::Method> chosen_method(const std::string& given) {
  if (given.empty()) return model::Method{};
  const base::Result<std::filesystem::path> file = io::find_in(io::kMethods, given, {});
  if (!file) return base::usage_error("--method {}", file.error().message);
  base::Result<io::MethodFile> method = io::load_method(*file);
  if (!method) return tl::unexpected(method.error());
  return std::move(method->method);
}

}  // namespace stickslip::cli
