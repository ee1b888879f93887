#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "cli/ask.hpp"
#include "cli/batch_text.hpp"
#include "cli/subcommands.hpp"
#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/clock.hpp"
#include "core/base/text.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/types/batch_journal.hpp"

namespace stickslip::cli {
namespace {

using Json = nlohmann::ordered_json;

struct VoidOptions : BenchOptions {
  std::string test;  ///< A number of the running daemon, or a record's file.
  std::string reason;
  bool restore = false;
};

/// In the journal beside the record, whatever runs.
base::Result<std::string> void_file(const VoidOptions& options) {
  const std::filesystem::path file{options.test};
  if (const auto read = record::read_record_apart(file); !read) return tl::unexpected(read.error());
  const std::filesystem::path folder =
      daemon::journal_folder_of(file).value_or(std::filesystem::absolute(file).parent_path());
  const std::string name = daemon::name_in_journal(folder, file);
  daemon::BatchJournal journal{folder};
  daemon::BatchBook book;
  if (const auto read = journal.read_on(book); !read) return tl::unexpected(read.error());
  const daemon::Voiding* const voided = book.voided(name);
  if (options.restore != (voided != nullptr)) {
    return base::failure("refused: {} {}", options.test,
                         voided == nullptr
                             ? std::string{"is not void"}
                             : fmt::format("is void already: {}, by {}", voided->reason, voided->who));
  }
  daemon::BatchEvent event{record::iso_time(base::make_system_clock()->realtime_ns()),
                           options.who.empty() ? user_name() : options.who, daemon::TestRestored{name}};
  if (!options.restore) event.what = daemon::TestVoided{name, options.reason};
  if (const auto written = journal.append(event); !written) return tl::unexpected(written.error());
  if (options.json) return io::json_document(Json{{"record", name}, {"voided", !options.restore}});
  return fmt::format("{}: {}; the file is untouched, {} says so\n", base::printable(options.test),
                     options.restore ? "counts again" : "does not count",
                     base::printable(journal.path().string()));
}

base::Result<std::string> run_void(const VoidOptions& options) {
  if (!options.restore) {
    if (options.reason.empty())
      return base::usage_error("--reason: is missing: why does {} not count?", options.test);
    if (const std::string why = base::name_refusal(options.reason); !why.empty())
      return base::usage_error("--reason: {}", why);
  }
  const bool is_number = !options.test.empty() && std::all_of(options.test.begin(), options.test.end(),
                                                              [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return void_file(options);
  Json body{{"test", Json::parse(options.test, nullptr, false)}};
  if (!options.restore) body["reason"] = options.reason;
  return batch_output(
      options, ask(options, {"POST", options.restore ? "/v1/restore" : "/v1/void", body.dump(), {}, {}}));
}

constexpr const char* kVoidExamples =
    R"(Examples:
  stickslip void 7 --reason "paper torn"
  stickslip void 7 --restore                                   it counts again
  stickslip void 7 --reason "sled slipped" --as ann)";

}  // namespace

void add_void(CLI::App& app, Chosen& chosen) {
  const auto options = std::make_shared<VoidOptions>();
  CLI::App* command =
      app.add_subcommand("void", "leave a test out of statistics, which say so; its file stays as it is");
  command->footer(kVoidExamples);
  add_bench_options(*command, *options, true);
  command->add_option("test", options->test, "its number in the running daemon, or its record")
      ->required()
      ->type_name("N|FILE.h5");
  command->add_option("--reason", options->reason, "such as \"paper torn\"")->type_name("TEXT");
  command->add_flag("--restore", options->restore, "it was voided by mistake: it counts again");
  choose(*command, chosen, [options] { return run_void(*options); });
}

}  // namespace stickslip::cli
