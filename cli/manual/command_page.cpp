#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "cli/manual/commands_of.hpp"
#include "cli/manual/pages.hpp"
#include "cli/manual/roff.hpp"

namespace stickslip::manual {
namespace {

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

/// "\fB\-o\fR, \fB\-\-output\fR \fIFILE\fR"
std::string names_of(const CLI::Option& option) {
  const std::string value =
      takes_value(option) ? fmt::format(" \\fI{}\\fR", roff(option.get_type_name())) : "";
  if (option.get_positional()) return fmt::format("\\fI{}\\fR", roff(option.get_type_name()));
  std::string names;
  for (const std::string& name : option.get_snames())
    names += fmt::format("{}\\fB\\-{}\\fR", names.empty() ? "" : ", ", roff(name));
  for (const std::string& name : option.get_lnames())
    names += fmt::format("{}\\fB\\-\\-{}\\fR", names.empty() ? "" : ", ", roff(name));
  return names + value;
}

std::vector<const CLI::Option*> options_of(const CLI::App& app, bool positional) {
  return app.get_options([positional](const CLI::Option* option) {
    return option->get_positional() == positional && !option->get_group().empty();
  });
}

std::string synopsis(const std::string& words, const CLI::App& app) {
  std::string line = fmt::format(".B {}\n", roff(words));
  if (!options_of(app, false).empty()) line += "[\\fIOPTIONS\\fR]\n";
  for (const CLI::Option* option : options_of(app, true)) {
    const std::string name = fmt::format("\\fI{}\\fR{}", roff(option->get_type_name()),
                                         option->get_items_expected_max() > 1 ? " ..." : "");
    line += option->get_required() ? name + "\n" : "[" + name + "]\n";
  }
  if (!commands_of(app).empty()) line += "\\fICOMMAND\\fR\n";
  return line;
}

std::string options(const CLI::App& app) {
  std::string text;
  for (const bool positional : {true, false}) {
    for (const CLI::Option* option : options_of(app, positional)) {
      std::string what = roff(option->get_description());
      if (!option->get_default_str().empty())
        what += roff(fmt::format("; default {}", option->get_default_str()));
      text += fmt::format(".TP\n{}\n{}\n", names_of(*option), what);
    }
  }
  return text;
}

std::string footer(const CLI::App& app, const char* heading) {
  if (app.get_footer().empty()) return {};
  return fmt::format("{}{}", heading, roff_example(app.get_footer()));
}

}  // namespace

std::string command_page(const CLI::App& app, const PageFacts& facts) {
  // "stickslip: friction tests from the command line"
  const std::string purpose = app.get_description();
  const std::size_t colon = purpose.find(": ");
  const std::string what = colon == std::string::npos ? purpose : purpose.substr(colon + 2);
  std::string page = fmt::format(".TH {} {} \"\" \"{}\" \"stickslip\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n{}",
                                 roff(upper(facts.name)), facts.section, roff(facts.version),
                                 roff(facts.name), roff(what), synopsis(facts.name, app));
  page += ".SH OPTIONS\n" + options(app);
  const auto commands = commands_of(app);
  if (!commands.empty()) page += ".SH COMMANDS\n";
  for (const CLI::App* command : commands) {
    page += fmt::format(".SS {}\n{}.PP\n{}\n{}", roff(command->get_name()),
                        synopsis(facts.name + " " + command->get_name(), *command),
                        roff(command->get_description()), options(*command));
    page += footer(*command, ".PP\n");
  }
  page += footer(app, ".SH EXAMPLES\n");
  for (const auto& [heading, text] :
       {std::pair{"EXIT STATUS", &facts.exit_status}, std::pair{"FILES", &facts.files},
        std::pair{"SEE ALSO", &facts.see_also}}) {
    if (!text->empty()) page += fmt::format(".SH {}\n{}\n", heading, *text);
  }
  return page;
}

}  // namespace stickslip::manual
