#include "report/chart_library.hpp"

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

namespace stickslip::report {

std::filesystem::path chart_folder() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  return program.parent_path().parent_path() / "share" / "stickslip" / "pages";
}

base::Result<ChartLibrary> read_chart_library(const std::filesystem::path& folder) {
  ChartLibrary library;
  for (const auto& [name, text] :
       {std::pair{"uplot.js", &library.script}, std::pair{"uplot.css", &library.style},
        std::pair{"uplot-license.txt", &library.license}}) {
    errno = 0;
    std::ifstream file{folder / name, std::ios::binary};
    text->assign(std::istreambuf_iterator<char>{file}, {});
    if (!file.is_open() || file.bad()) {
      return base::failure(
          "{}: {}: the pages need it; install the package again, or build it: ./dev build release pages",
          (folder / name).string(), std::generic_category().message(errno));
    }
  }
  return library;
}

}  // namespace stickslip::report
