#include "core/base/text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/wording.hpp"

namespace stickslip::base {
namespace {

constexpr std::string_view kFormulaStarts = "=+-@";

struct Character {
  std::size_t size = 1;
  char32_t code = 0;
  bool valid = false;
};

/// The first character. Overlong forms, surrogates and what lies above U+10FFFF are no UTF-8 (RFC 3629).
Character first_of(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  if (lead < 0x80U) return {1, lead, true};
  const std::size_t size = lead < 0xC2U ? 0U : lead < 0xE0U ? 2U : lead < 0xF0U ? 3U : lead < 0xF5U ? 4U : 0U;
  if (size == 0 || size > text.size()) return {};
  char32_t code = lead & (0xFFU >> (size + 1));
  for (std::size_t i = 1; i < size; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0U) != 0x80U) return {};
    code = (code << 6U) | (next & 0x3FU);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < kLeast[size] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {size, code, true};
}

constexpr bool deceives(char32_t code) noexcept {
  const auto within = [code](char32_t first, char32_t last) { return code >= first && code <= last; };
  return code < 0x20 || within(0x7F, 0x9F) || code == 0x61C || code == 0x200B || code == 0x200E ||
         code == 0x200F || within(0x2028, 0x202E) || within(0x2060, 0x206F) || code == 0xFEFF ||
         within(0xFFF9, 0xFFFB) || within(0xE0000, 0xE007F);
}

void add_shown(std::string& out, std::string_view text, const Character& character) {
  if (!character.valid || character.code < 0x20) {
    out += fmt::format("\\x{:02x}", static_cast<unsigned>(static_cast<unsigned char>(text.front())));
  } else if (deceives(character.code)) {
    // As in JSON: two halves of UTF-16 beyond four digits.
    const auto code = static_cast<unsigned>(character.code);
    out += code > 0xFFFFU ? fmt::format("\\u{:04x}\\u{:04x}", 0xD800U + ((code - 0x10000U) >> 10U),
                                        0xDC00U + (code & 0x3FFU))
                          : fmt::format("\\u{:04x}", code);
  } else {
    out += text.substr(0, character.size);
  }
}

std::string shown(std::string_view text, bool lines_stay, bool colours_stay) {
  const auto is_plain = [lines_stay](char c) {
    return (c >= ' ' && c <= '~') || (lines_stay && (c == '\n' || c == '\t'));
  };
  std::string out;
  out.reserve(text.size());
  for (;;) {
    // All but a few characters are plain: a run of them is copied at once.
    const auto plain = std::ranges::find_if_not(text, is_plain);
    out.append(text.begin(), plain);
    text.remove_prefix(static_cast<std::size_t>(plain - text.begin()));
    if (text.empty()) return out;
    std::size_t size = colours_stay ? colour_size(text) : 0;
    if (lines_stay && text.starts_with("\r\n")) size = 2;
    if (size > 0) {
      out += text.substr(0, size);
    } else {
      const Character character = first_of(text);
      add_shown(out, text, character);
      size = character.size;
    }
    text.remove_prefix(size);
  }
}

bool begins_a_formula(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \"'\u00a0");
  return first != text.npos && kFormulaStarts.find(text[first]) != kFormulaStarts.npos;
}

}  // namespace

std::size_t colour_size(std::string_view text) {
  if (!text.starts_with("\033[")) return 0;
  const std::size_t end = text.find_first_not_of("0123456789", 2);
  return end <= 4 && text[end] == 'm' ? end + 1 : 0;  // npos is larger.
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const Character character = first_of(text);
    if (!character.valid) return false;
    text.remove_prefix(character.size);
  }
  return true;
}

std::string printable(std::string_view text, bool colours_stay) { return shown(text, false, colours_stay); }

std::string printable_lines(std::string_view text, bool colours_stay) {
  return shown(text, true, colours_stay);
}

std::string csv_cell(std::string_view text) {
  std::string cell = printable(text);
  if (begins_a_formula(cell)) cell.insert(0, 1, '\'');
  // A line that begins with # would be one of comment.
  if (cell.find_first_of(",;\"") == cell.npos && !cell.starts_with('#')) return cell;
  std::string quoted = "\"";
  for (const char c : cell) quoted += c == '"' ? std::string{"\"\""} : std::string{c};
  return quoted + '"';
}

std::string csv_comment(std::string_view text) {
  std::string out;
  const std::string shown = printable(text);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    out += shown[i];
    if ((shown[i] == ',' || shown[i] == ';') && begins_a_formula(std::string_view{shown}.substr(i + 1)))
      out += '\'';
  }
  return out;
}

std::string name_refusal(std::string_view text, std::size_t longest) {
  if (!is_utf8(text)) return fmt::format("\"{}\" is no text in UTF-8: write it in UTF-8", one_line(text));
  if (text.size() > longest) {
    return fmt::format("\"{}\" is {} bytes long, at most {} are allowed: shorten it", one_line(text),
                       text.size(), longest);
  }
  for (std::string_view rest = text; !rest.empty();) {
    const Character character = first_of(rest);
    if (deceives(character.code)) {
      return fmt::format("\"{}\" holds the control character {}: leave it out", one_line(text),
                         printable(rest.substr(0, character.size)));
    }
    rest.remove_prefix(character.size);
  }
  return {};
}

}  // namespace stickslip::base
