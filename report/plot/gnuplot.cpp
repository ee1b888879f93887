#include "report/plot/gnuplot.hpp"

#include <cstddef>
#include <optional>

#include "io/child_process.hpp"

#include "core/base/wording.hpp"

namespace stickslip::plot {

base::Result<std::string> run_gnuplot(std::string_view commands) {
  const base::Result<std::optional<io::ChildAnswer>> answer =
      io::ask_program("gnuplot", {"--default-settings"}, commands);
  if (!answer) return tl::unexpected(answer.error());
  if (!*answer) {
    return base::failure(
        "pictures are drawn by gnuplot, which is not installed; on Debian: apt-get install gnuplot-nox");
  }
  const io::ChildAnswer& picture = **answer;
  constexpr std::size_t kLongestWords = 300;
  if (picture.status != 0 || picture.output.empty()) {
    return base::failure("gnuplot ended with status {}: {}", picture.status,
                         base::one_line(picture.errors, kLongestWords));
  }
  return picture.output;
}

}  // namespace stickslip::plot
