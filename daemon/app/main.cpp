// stickslipd: the daemon. Exit status 0 after a signal or the end of the input, 1 if the world did
// not allow it to work, 2 if it was told something wrong.

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include "io/config.hpp"
#include "io/print_text.hpp"
#include "report/truth_table.hpp"
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

#include "core/base/shell_word.hpp"
#include "core/base/version.hpp"
#include "core/record/read_apart.hpp"
#include "daemon/app/app.hpp"
#include "daemon/app/log.hpp"
#include "daemon/fleet/backlog.hpp"
#include "daemon/page/report_jobs.hpp"
#include "daemon/runtime/stray_signals.hpp"
#include "daemon/storage/finaliser_process.hpp"
#include "daemon/types/daemon_options.hpp"

namespace stickslip::app {
namespace {

int refused(const base::Error& error) {
  io::print_error("stickslipd", error.message);
  return error.exit_status();
}

base::Result<io::DaemonConfig> good_config(const std::string& file) {
  base::Result<io::DaemonConfig> config = io::load_config(file);
  if (!config) return config;
  if (base::Result<void> board = drivers::check_board(config->board); !board)
    return tl::unexpected(board.error());
  return config;
}

int check_config(const std::string& file) {
  const auto config = good_config(file);
  if (!config) return refused(config.error());
  for (const std::string& warning : config->warnings)
    fmt::print("{}: {}\n", base::printable(file), base::printable(warning));
  fmt::print("{}: good\n", base::printable(file));
  return 0;
}

int finalise_journal(const std::string& journal, std::optional<std::int64_t> expected_scans) {
  const base::Result<record::Finalised> made = storage::finalise_here(journal, expected_scans);
  if (!made) return refused(made.error());
  fmt::print("{}", storage::to_text(*made));
  return 0;
}

int print_result(const std::string& file) {
  const base::Result<std::string> result = fleet::result_of_record(file);
  if (!result) return refused(result.error());
  io::print_text(stdout, *result);
  return 0;
}

/// Shows the daemon's state in one line of the terminal.
void show_status(const std::string& line) {
  fmt::print("\r\033[K{}", base::printable(line));
  std::fflush(stdout);
}

/// `stickslip` as a shell finds it: by its name if it is installed, else by its path.
std::string program_for_shell() {
  const std::string program = page::program_beside_this();
  return program.starts_with("/usr/") ? "stickslip" : program;
}

/// The table of the tests of this run, where their records are, and what can be done with them next.
void print_table(const daemon::TestLog& tests) {
  std::vector<report::TableRow> rows;
  std::filesystem::path folder;
  for (daemon::TestSummary& test : tests.tests()) {
    if (test.earlier) continue;
    std::error_code error;
    const std::filesystem::path file = std::filesystem::absolute(test.file, error);
    if (test.file_error.empty()) folder = file.parent_path();
    rows.push_back(
        {test.number, std::move(test.results), std::move(test.truth),
         test.file_error.empty() ? file.filename().string() : fmt::format("no file: {}", test.file_error)});
  }
  if (rows.empty()) return;
  std::string text = report::format_table(rows);
  if (!folder.empty()) {
    const std::string records = base::shell_word(folder.string());
    text += fmt::format(
        "records in {}\n\nNext, means and traces of these tests as one page for a browser:\n"
        "  {} report {}/*.h5 -o demo.html\n",
        records, base::shell_word(program_for_shell()), records);
  }
  io::print_text(stdout, text);
}

/// Handles the signals between two Apps of a reload. A running App handles them itself.
class SignalsBetween {
 public:
  explicit SignalsBetween(bool reloads) {
    if (reloads) hangups_.add(SIGHUP);
    stops_.async_wait([this](boost::system::error_code error, int /*signal*/) { stop_asked_ = !error; });
  }
  /// True if SIGTERM or SIGINT has come since the start.
  [[nodiscard]] bool stop_asked() {
    io_.poll();
    return stop_asked_;
  }

 private:
  bool stop_asked_ = false;
  boost::asio::io_context io_{1};
  boost::asio::signal_set stops_{io_, SIGTERM, SIGINT};
  boost::asio::signal_set hangups_{io_};
};

int run(const std::string& file) {
  base::Result<io::DaemonConfig> config = io::load_config(file);
  if (!config) return refused(config.error());
  runtime::ignore_stray_signals();
  // In a terminal a SIGHUP says that the terminal is gone.
  const bool reloads = ::isatty(STDIN_FILENO) == 0;
  SignalsBetween signals{reloads};
  // A replay's record is read before anything else hears of a signal.
  record::read_records_apart([&signals] { return signals.stop_asked(); });
  for (std::optional<io::DaemonConfig> next{*std::move(config)}; next;) {
    const bool table = next->report_table;
    const bool terminal = table && ::isatty(STDOUT_FILENO) != 0;
    const std::unique_ptr<daemon::EventReceiver> log = make_log(next->log_level);
    for (const std::string& warning : next->warnings) log->config_outdated(warning);

    base::Result<runtime::RecordFolder> folder = runtime::prepare_record_folder(next->record_folder);
    if (!folder) return refused(folder.error());
    AppWorld world;
    world.record_folder = *std::move(folder);
    world.open_board = drivers::open_board;
    world.finalise = [](const std::filesystem::path& journal, std::optional<std::int64_t> expected) {
      return storage::run_finaliser("/proc/self/exe", journal, expected);
    };
    world.events = log.get();
    world.stop_asked = [&signals] { return signals.stop_asked(); };
    // The configuration that was checked: it may be used much later.
    if (reloads) {
      world.check_config = [&file, &next]() -> base::Result<void> {
        base::Result<io::DaemonConfig> found = good_config(file);
        if (!found) return tl::unexpected(found.error());
        next = *std::move(found);
        return {};
      };
    }
    if (terminal) world.status_changed = show_status;

    App app{*std::exchange(next, std::nullopt), std::move(world)};
    const base::Result<void> ended = app.run();
    if (terminal) show_status("");
    if (!ended) return refused(ended.error());
    if (table) print_table(app.tests());
    if (!app.is_to_be_reloaded()) return 0;
  }
  return 0;
}

int main_of(int count, char** arguments) {
  CLI::App parser{daemon::kDaemonPurpose, "stickslipd"};
  daemon::DaemonOptions options;
  daemon::declare_daemon_options(parser, options);
  parser.set_version_flag("--version", fmt::format("stickslipd {} ({})", base::kVersion, base::kCommit));
  try {
    parser.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return parser.exit(error);
    io::print_error("stickslipd", fmt::format("{}; see stickslipd --help", error.what()));
    return 2;
  }
  if (!options.config_to_check.empty()) return check_config(options.config_to_check);
  if (!options.journal.empty()) return finalise_journal(options.journal, options.scans);
  if (!options.record.empty()) return print_result(options.record);
  return run(options.config);
}

}  // namespace
}  // namespace stickslip::app

int main(int count, char** arguments) {
  stickslip::record::serve_if_reader(count, arguments);
  try {
    stickslip::record::read_records_apart();
    return stickslip::app::main_of(count, arguments);
  } catch (const std::exception& error) {
    stickslip::io::print_error("stickslipd", error.what());
    return 1;
  }
}
