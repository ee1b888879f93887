#include "report/wrapped.hpp"

#include <algorithm>

#include "io/table.hpp"

namespace stickslip::report {

std::string wrapped(const std::string& line, std::size_t indent) {
  constexpr std::size_t kWidth = 80;
  std::string text;
  std::size_t column = 0;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t blanks = line.find_first_not_of(' ', at);
    if (blanks == std::string::npos) break;
    const std::size_t end = std::min(line.find(' ', blanks), line.size());
    const std::string word = line.substr(at, end - at);
    const std::size_t width = io::display_width(word);
    if (column + width > kWidth && column > indent) {
      text += "\n" + std::string(indent, ' ') + line.substr(blanks, end - blanks);
      column = indent + width - (blanks - at);
    } else {
      text += word;
      column += width;
    }
    at = end;
  }
  return text;
}

}  // namespace stickslip::report
