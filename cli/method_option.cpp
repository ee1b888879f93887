#include "cli/method_option.hpp"

#include "io/library.hpp"
#include "io/method_file.hpp"

namespace stickslip::cli {

void add_method_option(CLI::App& command, std::string& method) {
  command
      .add_option("--method", method,
                  "test method by which the traditional coefficients are read: file.toml, or name as in "
                  "stickslip methods")
      ->type_name("METHOD");
}

base::Result<model::Method> chosen_method(const std::string& given) {
  if (given.empty()) return model::Method{};
  const base::Result<std::filesystem::path> file = io::find_in(io::kMethods, given, {});
  if (!file) return base::usage_error("--method {}", file.error().message);
  base::Result<io::MethodFile> method = io::load_method(*file);
  if (!method) return tl::unexpected(method.error());
  return std::move(method->method);
}

}  // namespace stickslip::cli
