#include <memory>
#include <string>

#include "cli/bench_command.hpp"

namespace stickslip::cli {
namespace {

struct MarkOptions : BenchCommand {
  std::string text;
};

constexpr const char* kMarkExamples =
    R"(Examples:
  stickslip mark "sheet moved"
  stickslip mark "humidity 52 %" --as ann
  stickslip mark "sheet moved" --key 7-1                       sent again, it is not written twice)";

}  // namespace

void add_mark(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<MarkOptions>();
  options->verb = "mark";
  CLI::App* command = add_bench_command(app, *options, "write a remark into the record of the running test");
  command->footer(kMarkExamples);
  command->add_option("text", options->text, "the remark")->required()->type_name("TEXT");
  choose(*command, chosen, [options] {
    nlohmann::ordered_json body = nlohmann::ordered_json::object();
    if (!options->text.empty()) body["text"] = options->text;
    return run_bench_command(*options, body);
  });
}

}  // namespace stickslip::cli
