#include "cli/batch_text.hpp"

#include <fmt/format.h>

#include "cli/json_members.hpp"
#include "io/table.hpp"
#include <nlohmann/json.hpp>

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string step_text(const Json& step) {
  const Json& speed = step["pull_speed"];
  return fmt::format("{}sheet {}, slide {}",
                     speed.is_number() ? fmt::format("{:.6g} m/s, ", speed.get<double>()) : "",
                     step["replicate"].dump(), step["slide"].dump());
}

/// The whole answer of /v1/batch for people.
std::string batch_text(const Json& answer) {
  const Json& batch = answer["batch"];
  if (batch.is_null()) return "there is no batch; stickslip batch begin --name NAME plans one\n";
  io::Table tests = io::Table::list({0, 0});
  for (const Json& test : batch["tests"]) {
    tests.add({"  " + step_text(test), word(test, "record")});
    if (const Json& voided = test["voided"]; !voided.is_null())
      tests.add({fmt::format("    void: {}, by {}", word(voided, "reason"), word(voided, "by"))});
  }
  std::string text =
      fmt::format("batch {}: {}, {} of {} tests made\n{}", batch["id"].get<std::string>(),
                  word(batch, "name"), batch["done"].dump(), batch["planned"].dump(), tests.text());
  text += batch["next"].is_null() ? "all are made\n" : fmt::format("next: {}\n", step_text(batch["next"]));
  if (batch["trouble"].is_string()) text += fmt::format("trouble: {}\n", batch["trouble"].get<std::string>());
  return text;
}

}  // namespace

base::Result<std::string> batch_output(const BenchOptions& options, const base::Result<Json>& answer) {
  if (!answer) return tl::unexpected(answer.error());
  return options.json ? answer->dump(2) + "\n" : batch_text(*answer);
}

}  // namespace stickslip::cli
