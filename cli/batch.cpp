// Batches and void tests, from the command line.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <utility>

#include "cli/ask.hpp"
#include "cli/commands.hpp"
#include "cli/json_words.hpp"
#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/clock.hpp"
#include "core/base/text.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/types/batch_journal.hpp"
#include "daemon/types/plan_json.hpp"

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
  std::string text = fmt::format("batch {}: {}, {} of {} tests made\n", batch["id"].get<std::string>(),
                                 word(batch, "name"), batch["done"].dump(), batch["planned"].dump());
  for (const Json& test : batch["tests"]) {
    text += fmt::format("  {:<36}  {}\n", step_text(test), test["record"].get<std::string>());
    if (const Json& voided = test["voided"]; !voided.is_null())
      text += fmt::format("    void: {}, by {}\n", voided["reason"].get<std::string>(),
                          voided["by"].get<std::string>());
  }
  text += batch["next"].is_null() ? "all are made\n" : fmt::format("next: {}\n", step_text(batch["next"]));
  if (batch["trouble"].is_string()) text += fmt::format("trouble: {}\n", batch["trouble"].get<std::string>());
  return text;
}

base::Result<std::string> told(const BenchOptions& options, const base::Result<Json>& answer) {
  if (!answer) return tl::unexpected(answer.error());
  return options.json ? answer->dump(2) + "\n" : batch_text(*answer);
}

std::optional<double> number_in(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "mu_k=0.2:0.4" into the plan's limits.
base::Result<void> add_limit(Json& limits, const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t colon = text.find(':', equals == std::string::npos ? 0 : equals);
  const auto wrong = [&text] {
    return base::usage_error("--limit {}: must be RESULT=LOWEST:HIGHEST, such as mu_k=0.2:0.4 or mu_k=:0.4",
                             text);
  };
  if (equals == std::string::npos || colon == std::string::npos) return wrong();
  Json limit = Json::object();
  for (const auto& [side, typed] : {std::pair{"lowest", text.substr(equals + 1, colon - equals - 1)},
                                    {"highest", text.substr(colon + 1)}}) {
    if (typed.empty()) continue;
    const auto value = number_in(typed);
    if (!value) return wrong();
    limit[side] = *value;
  }
  limits[text.substr(0, equals)] = std::move(limit);
  return {};
}

/// In the journal beside the record, whatever runs.
base::Result<std::string> void_file(const BenchOptions& options, const VoidCommand& command) {
  const std::filesystem::path file{command.test};
  if (const auto read = record::read_record_apart(file); !read) return tl::unexpected(read.error());
  const std::filesystem::path folder =
      daemon::journal_folder_of(file).value_or(std::filesystem::absolute(file).parent_path());
  const std::string name = daemon::name_in_journal(folder, file);
  daemon::BatchJournal journal{folder};
  daemon::BatchBook book;
  if (const auto read = journal.read_on(book); !read) return tl::unexpected(read.error());
  const daemon::Voiding* const voided = book.voided(name);
  if (command.restore != (voided != nullptr)) {
    return base::failure("refused: {} {}", command.test,
                         voided == nullptr
                             ? std::string{"is not void"}
                             : fmt::format("is void already: {}, by {}", voided->reason, voided->who));
  }
  daemon::BatchEvent event{record::iso_time(base::make_system_clock()->realtime_ns()),
                           options.who.empty() ? user_name() : options.who, daemon::TestRestored{name}};
  if (!command.restore) event.what = daemon::TestVoided{name, command.reason};
  if (const auto written = journal.append(event); !written) return tl::unexpected(written.error());
  if (options.json) return io::json_document(Json{{"record", name}, {"voided", !command.restore}});
  return fmt::format("{}: {}; the file is untouched, {} says so\n", base::printable(command.test),
                     command.restore ? "counts again" : "does not count",
                     base::printable(journal.path().string()));
}

}  // namespace

base::Result<std::string> run_batch_show(const BenchOptions& options) {
  return told(options, ask(options, {"GET", "/v1/batch", {}, {}, {}}));
}

base::Result<std::string> run_batch_begin(const BenchOptions& options, const BatchCommand& command) {
  Json plan = Json::object();
  for (const auto& [key, text] : command.facts) plan[key] = text;
  if (!command.pull_speeds.empty()) plan["pull_speeds"] = command.pull_speeds;
  if (command.replicates) plan["replicates"] = *command.replicates;
  if (command.slides) plan["slides"] = *command.slides;
  Json limits = Json::object();
  for (const std::string& limit : command.limits) {
    if (const auto added = add_limit(limits, limit); !added) return tl::unexpected(added.error());
  }
  if (!limits.empty()) plan["limits"] = std::move(limits);
  const base::Result<std::string> said = body_of(plan);
  if (!said) return tl::unexpected(said.error());
  return told(options, ask(options, {"POST", "/v1/batch", *said, {}, {}}));
}

base::Result<std::string> run_batch_end(const BenchOptions& options) {
  return told(options, ask(options, {"DELETE", "/v1/batch", {}, {}, {}}));
}

base::Result<std::string> run_void(const BenchOptions& options, const VoidCommand& command) {
  if (!command.restore) {
    if (command.reason.empty())
      return base::usage_error("--reason: is missing: why does {} not count?", command.test);
    if (const std::string why = base::name_refusal(command.reason); !why.empty())
      return base::usage_error("--reason: {}", why);
  }
  const bool is_number = !command.test.empty() && std::all_of(command.test.begin(), command.test.end(),
                                                              [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return void_file(options, command);
  Json body{{"test", Json::parse(command.test, nullptr, false)}};
  if (!command.restore) body["reason"] = command.reason;
  return told(options,
              ask(options, {"POST", command.restore ? "/v1/restore" : "/v1/void", body.dump(), {}, {}}));
}

}  // namespace stickslip::cli
