#include <fmt/format.h>

#include <cctype>
#include <regex>
#include <sstream>

#include "cli/manual/pages.hpp"
#include "cli/manual/roff.hpp"

namespace stickslip::manual {
namespace {

/// Joins the words of a text by single spaces.
std::string plain(const std::string& text) {
  std::istringstream in{text};
  std::string out;
  for (std::string word; in >> word;) out += (out.empty() ? "" : " ") + word;
  return out;
}

}  // namespace

std::string config_page(std::string_view text, const PageFacts& facts) {
  static const std::regex header{R"(\[([a-z_.]+)\]\s*(?:#\s*(.*))?)"};
  static const std::regex key{R"re((?:# )?([a-z_]+ = (?:"[^"]*"|\[[^\]]*\]|[^\s#]+))\s*(?:#\s*(.*))?)re"};
  static const std::regex more{R"(\s*#\s{2,}(.*))"};
  std::string page = fmt::format(
      ".TH {} {} \"\" \"{}\" \"stickslip\"\n.SH NAME\n{} \\- configuration of the friction tester\n.SH "
      "DESCRIPTION\n",
      "STICKSLIPD.TOML", facts.section, roff(facts.version), roff(facts.name));
  std::istringstream in{std::string{text}};
  std::string what;       ///< Text of the header or key, which the next line may continue.
  std::string paragraph;  ///< Macro before the next text.
  const auto close = [&page, &what, &paragraph] {
    if (!what.empty()) page += paragraph + roff(plain(what)) + "\n";
    what.clear();
    paragraph.clear();
  };
  bool in_tables = false;
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_match(line, match, header)) {
      close();
      in_tables = true;
      paragraph.clear();
      page += fmt::format(".SH [{}]\n", roff(match[1].str()));
      what = match[2];
    } else if (in_tables && std::regex_match(line, match, key)) {
      close();
      page += fmt::format(".TP\n\\fB{}\\fR\n", roff(match[1].str()));
      what = match[2];
    } else if (in_tables && std::regex_match(line, match, more)) {
      what += " " + match[1].str();
    } else if (!in_tables && line.starts_with("# ")) {
      what += " " + line.substr(2);
    } else if (!in_tables) {
      close();
      paragraph = ".PP\n";
    }
  }
  close();
  if (!facts.see_also.empty()) page += fmt::format(".SH SEE ALSO\n{}\n", facts.see_also);
  return page;
}

}  // namespace stickslip::manual
