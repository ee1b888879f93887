/// \file
/// Text that an enemy of terminals, tables and pages would write.
#pragma once

#include <rapidcheck.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/text.hpp"

namespace stickslip::test {

inline constexpr std::array<std::string_view, 27> kHostilePieces{"\n",
                                                                 "\r\n",
                                                                 "\r",
                                                                 "\t",
                                                                 "\x1b[2K",
                                                                 "\x7f",
                                                                 "\xc2\x9b",
                                                                 "\xe2\x80\xae",
                                                                 "\xe2\x80\xa8",
                                                                 "\xe2\x81\xa6",
                                                                 "\xef\xbb\xbf",
                                                                 "\xf3\xa0\x81\xa1",
                                                                 "\xff",
                                                                 "\xc0\xaf",
                                                                 "\xed\xa0\x80",
                                                                 "\xf4\x90\x80\x80",
                                                                 "\xe2\x80",
                                                                 "=1+1",
                                                                 "+",
                                                                 "-",
                                                                 "@x",
                                                                 "\"",
                                                                 ",",
                                                                 ";",
                                                                 "</script>",
                                                                 "\xce\xb3",
                                                                 " "};

/// Texts that would forge a line, clear a terminal, turn the direction of text or become a formula.
inline rc::Gen<std::string> hostile() {
  return rc::gen::map(rc::gen::container<std::vector<std::string>>(rc::gen::oneOf(
                          rc::gen::map(rc::gen::inRange<std::size_t>(0, kHostilePieces.size()),
                                       [](std::size_t i) { return std::string{kHostilePieces.at(i)}; }),
                          rc::gen::arbitrary<std::string>())),
                      [](const std::vector<std::string>& pieces) {
                        std::string text;
                        for (const std::string& piece : pieces) text += piece;
                        return text;
                      });
}

inline std::ptrdiff_t lines_of(std::string_view text) { return std::count(text.begin(), text.end(), '\n'); }

/// UTF-8 with no control character but the line feeds.
inline void expect_safe(std::string_view text) {
  RC_ASSERT(base::is_utf8(text));
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    RC_ASSERT(base::printable(line) == line);
    for (const char c : line) RC_ASSERT((static_cast<unsigned char>(c) >= 0x20 && c != '\x7f'));
    for (const char* bad :
         {"\xc2\x9b", "\xe2\x80\xae", "\xe2\x80\xa8", "\xe2\x81\xa6", "\xef\xbb\xbf", "\xf3\xa0\x81\xa1"})
      RC_ASSERT(line.find(bad) == line.npos);
    begin = end + 1;
  }
}

}  // namespace stickslip::test
