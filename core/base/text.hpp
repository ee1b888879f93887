/// \file
/// Untrusted text (names, remarks, paths, requests): made safe for output, and checked at input.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace stickslip::base {

/// Longest accepted name or remark, bytes.
inline constexpr std::size_t kLongestName = 200;

[[nodiscard]] bool is_utf8(std::string_view text);

/// Number of bytes of a colour code "ESC [ digits m", of no, one or two digits, at the beginning of the text;
/// 0 if there is none.
[[nodiscard]] std::size_t colour_size(std::string_view text);

/// The text as one line of valid UTF-8. Shown by their numbers: control characters below 0x20 and bytes that
/// are no UTF-8 (\x1b), other control characters (\u007f, \u009b), what changes the direction of text or
/// breaks a line (\u202e, \u2028), and characters without width (\u200b, \u2060, \ufeff, tags). Words and
/// signs need the joiners U+200C and U+200D and variation selectors: they stay, as do rare characters without
/// width. All other text, in any language, stays as it is, including a backslash, so that the result cannot
/// be converted back.
/// \param colours_stay  true: colour codes stay; the caller has escaped those of untrusted text.
[[nodiscard]] std::string printable(std::string_view text, bool colours_stay = false);

/// As printable(), for a whole output: line feed, a CR before it, and tab stay, since they belong to the
/// output's format. JSON stays equal JSON.
[[nodiscard]] std::string printable_lines(std::string_view text, bool colours_stay = false);

/// A text as one cell of a table in CSV: printable(); in quotes (RFC 4180) if it has a comma, a semicolon or
/// a quote, or begins with #, which readers take for a comment; with an apostrophe in front if a spreadsheet
/// would take it for a formula (it begins with = + - @, also after blanks and quotes). Not for numbers.
[[nodiscard]] std::string csv_cell(std::string_view text);

/// A text for a comment line of a table in CSV, without the #: printable(), with an apostrophe behind each
/// comma or semicolon that a formula would follow, since spreadsheets cut the line there.
[[nodiscard]] std::string csv_comment(std::string_view text);

/// Reason why a text is refused as a name or remark, with the remedy; empty if it is accepted. Accepted is
/// UTF-8 of at most `longest` bytes that printable() would not change, also an empty text. The caller
/// prefixes the place.
[[nodiscard]] std::string name_refusal(std::string_view text, std::size_t longest = kLongestName);

}  // namespace stickslip::base
