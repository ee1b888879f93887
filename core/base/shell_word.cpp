#include "core/base/shell_word.hpp"

namespace stickslip::base {

std::string shell_word(std::string_view argument) {
  const bool plain =
      !argument.empty() && argument.find_first_of(" \t\n\"'\\$`*?[](){}<>|&;#~!") == argument.npos;
  if (plain) return std::string{argument};
  std::string word = "'";
  for (const char c : argument) word += c == '\'' ? std::string{"'\\''"} : std::string{c};
  return word + "'";
}

}  // namespace stickslip::base
