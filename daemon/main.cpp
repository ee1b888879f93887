// stickslipd: the daemon. Exit status 0 after a signal or the end of the input, 1 if the world did
// not allow it to work, 2 if it was told something wrong.

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "daemon/app.hpp"
#include "daemon/config.hpp"
#include "daemon/daemon_options.hpp"
#include "daemon/finaliser.hpp"
#include "daemon/fleet/backlog.hpp"
#include "daemon/log.hpp"
#include "daemon/report/table.hpp"
#include "daemon/version.hpp"

namespace stickslip::daemon {
namespace {

int refused(const base::Error& error) {
  fmt::print(stderr, "stickslipd: {}\n", error.message);
  return error.exit_status();
}

int check_config(const std::string& file) {
  const base::Result<DaemonConfig> config = load_config(file);
  if (!config) return refused(config.error());
  if (const base::Result<void> board = drivers::check_board(config->board); !board)
    return refused(board.error());
  fmt::print("{}: good\n", file);
  return 0;
}

int finalise_journal(const std::string& journal) {
  const base::Result<std::filesystem::path> file = finalise_here(journal);
  return file ? 0 : refused(file.error());
}

int print_result(const std::string& file) {
  const base::Result<std::string> result = result_of_record(file);
  if (!result) return refused(result.error());
  fmt::print("{}", *result);
  return 0;
}

/// Follows the daemon's state in one line of a terminal.
void show_status(const std::string& line) {
  fmt::print("\r\033[K{}", line);
  std::fflush(stdout);
}

void print_table(const TestLog& tests) {
  std::vector<TableRow> rows;
  for (TestSummary& test : tests.tests()) {
    rows.push_back(
        {test.number, std::move(test.results), std::move(test.truth),
         test.file_error.empty() ? std::move(test.file) : fmt::format("no file: {}", test.file_error)});
  }
  if (!rows.empty()) fmt::print("{}", format_table(rows));
}

int run(const std::string& file) {
  base::Result<DaemonConfig> config = load_config(file);
  if (!config) return refused(config.error());
  // A limit to the size of files is an error of writing (EFBIG), not an end.
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  const bool table = config->report_table;
  const bool terminal = table && ::isatty(STDOUT_FILENO) != 0;
  const std::unique_ptr<Facts> log = make_log(config->log_level);

  AppWorld world;
  world.open_board = drivers::open_board;
  world.finalise = [](const std::filesystem::path& journal) {
    return run_finaliser("/proc/self/exe", journal);
  };
  world.facts = log.get();
  if (terminal) world.status_changed = show_status;

  App app{std::move(*config), std::move(world)};
  const base::Result<void> ended = app.run();
  if (terminal) show_status("");
  if (!ended) return refused(ended.error());
  if (table) print_table(app.tests());
  return 0;
}

int main_of(int count, char** arguments) {
  CLI::App parser{kDaemonPurpose, "stickslipd"};
  DaemonOptions options;
  declare_daemon_options(parser, options);
  parser.set_version_flag("--version", fmt::format("stickslipd {} ({})", kVersion, kCommit));
  try {
    parser.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return parser.exit(error);
    fmt::print(stderr, "stickslipd: {}; see stickslipd --help\n", error.what());
    return 2;
  }
  if (!options.config_to_check.empty()) return check_config(options.config_to_check);
  if (!options.journal.empty()) return finalise_journal(options.journal);
  if (!options.record.empty()) return print_result(options.record);
  return run(options.config);
}

}  // namespace
}  // namespace stickslip::daemon

int main(int count, char** arguments) {
  try {
    return stickslip::daemon::main_of(count, arguments);
  } catch (const std::exception& error) {
    fmt::print(stderr, "stickslipd: {}\n", error.what());
    return 1;
  }
}
