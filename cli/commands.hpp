/// \file
/// The subcommands of `stickslip`. Each returns what to print on stdout, or an error; nothing is
/// printed and no file is left before all of it has succeeded.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/scene_options.hpp"

#include "core/base/result.hpp"

namespace stickslip::cli {

/// Numbers as typed: "350", "350 Hz", "12 in/min"; bare numbers are in SI units.
struct ImportCommand {
  std::string csv;
  std::string column;
  std::string time_column;
  std::string rate;
  std::string unit;  ///< "coefficient", "N" or "V".
  std::string speed;
  std::string sled_mass;
  std::string stiffness;
  std::string load_cell_gain;
  std::string load_cell_zero;
  std::string method;  ///< As chosen_method() takes it.
  std::string output;
};

[[nodiscard]] base::Result<std::string> run_import(const ImportCommand& command);

struct AnalyzeCommand {
  std::vector<std::string> files;
  std::string method;     ///< As chosen_method() takes it; empty: that of each record.
  std::string tester;     ///< File of a characterisation; empty: none.
  std::string estimator;  ///< "peak", "interpolated" or "fit"; empty: that of each record.
  /// Of analysis::kKeptNames, or "nothing" alone; empty: as each record says.
  std::vector<std::string> keep;
  bool effects = false;  ///< What each of them does, beside the results.
  bool json = false;
};

[[nodiscard]] base::Result<std::string> run_analyze(const AnalyzeCommand& command);

struct CharacteriseCommand {
  std::vector<std::string> files;  ///< Records of ring-downs.
  std::string output;              ///< Empty: none.
  bool json = false;
};

[[nodiscard]] base::Result<std::string> run_characterise(const CharacteriseCommand& command);

struct SimulateCommand : SceneOptions {
  std::string method;  ///< As chosen_method() takes it.
  std::string output;
  bool json = false;
  std::string line;  ///< The whole command, for the record.
};

[[nodiscard]] base::Result<std::string> run_simulate(const SimulateCommand& command);

struct SweepCommand : SceneOptions {
  std::string output;
  std::vector<std::string> vary;  ///< As parse_axis() takes them.
  std::string repeat = "1";
  std::string threads;  ///< Empty: as many as there are processors.
  bool json = false;
};

/// Catches SIGINT and SIGTERM while it runs: the first stops the sweep (ErrorKind::kInterrupted), the next
/// the program.
[[nodiscard]] base::Result<std::string> run_sweep(const SweepCommand& command);

/// Times as typed, as above.
struct PlotCommand {
  std::string input;   ///< A record; or a scene, as in SceneOptions.
  std::string output;  ///< Empty: the input's name with .svg, in the working folder.
  std::string folder;  ///< As in SimulateCommand.
  std::string from;
  std::string to;
  bool overview = false;
  bool derivative = false;
};

[[nodiscard]] base::Result<std::string> run_plot(const PlotCommand& command);

struct AccuracyCommand : SceneOptions {
  std::string output;  ///< .svg or .html; empty: none.
  bool json = false;
};

[[nodiscard]] base::Result<std::string> run_accuracy(const AccuracyCommand& command);

struct ReportOptions {
  std::string csv;   ///< File to make; empty: none; "-": the standard output, instead of the text.
  std::string page;  ///< HTML file to make; likewise.
  bool json = false;
};

struct ReportCommand : ReportOptions {
  std::vector<std::string> files;  ///< Of a batch: the folder of its records, one.
  std::string batch;               ///< Its identifier or name; empty: the files are records.
};

[[nodiscard]] base::Result<std::string> run_report(const ReportCommand& command);

struct CompareCommand : ReportOptions {
  std::vector<std::string> a;  ///< Of two batches: the folder of their records, one.
  std::vector<std::string> b;
  std::string batch_a;  ///< Its identifier or name; empty: the files are records.
  std::string batch_b;
  std::string label_a = "A";
  std::string label_b = "B";
};

[[nodiscard]] base::Result<std::string> run_compare(const CompareCommand& command);

/// \param folder  as in SceneOptions.
[[nodiscard]] base::Result<std::string> run_scenes(const std::string& folder, bool json);

/// \param folder  of the methods; empty: where the program finds them.
[[nodiscard]] base::Result<std::string> run_methods(const std::string& folder, bool json);

struct BoardsOutput {
  std::string text;
  bool any_usable = false;
};

/// Boards under Linux Comedi, what they offer, and a configuration for each. \param devices  empty: all there
/// are.
[[nodiscard]] BoardsOutput run_boards(std::vector<std::string> devices, bool json);

[[nodiscard]] base::Result<std::string> run_status(const std::string& socket, bool json);

/// Of all that talk to the running daemon.
struct BenchOptions {
  std::string socket = "/run/stickslip/control.sock";
  std::string who;  ///< Empty: user and host.
  bool json = false;
};

struct BenchCommand {
  std::string verb;  ///< "arm", "start", "stop", "mark", "tare".
  std::string text;  ///< Of a mark.
  std::optional<std::int64_t> test;
  std::string key;  ///< Idempotency-Key; empty: none.
};

[[nodiscard]] base::Result<std::string> run_bench_command(const BenchOptions& options,
                                                          const BenchCommand& command);

struct PlanCommand {
  bool clear = false;
  std::vector<std::pair<std::string, std::string>> changes;  ///< Key and what is typed.
};

[[nodiscard]] base::Result<std::string> run_plan(const BenchOptions& options, const PlanCommand& command);
[[nodiscard]] base::Result<std::string> run_list(const BenchOptions& options);
[[nodiscard]] base::Result<std::string> run_show(const BenchOptions& options, std::int64_t number_of_test);
/// The current batch.
[[nodiscard]] base::Result<std::string> run_batch_show(const BenchOptions& options);
struct BatchCommand {
  /// Key of the plan and what is typed; lists are given key by key.
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<std::string> pull_speeds;
  std::optional<std::int64_t> replicates;
  std::optional<std::int64_t> slides;
  std::vector<std::string> limits;  ///< "mu_k=0.2:0.4"; either side may be absent.
};
[[nodiscard]] base::Result<std::string> run_batch_begin(const BenchOptions& options,
                                                        const BatchCommand& command);
[[nodiscard]] base::Result<std::string> run_batch_end(const BenchOptions& options);

struct VoidCommand {
  std::string test;  ///< A number of the running daemon, or a record's file.
  std::string reason;
  bool restore = false;
};
/// A file needs no daemon: the journal beside it is written.
[[nodiscard]] base::Result<std::string> run_void(const BenchOptions& options, const VoidCommand& command);

/// Prints as it comes. \param tests  to wait for the end of; 0: for ever.
[[nodiscard]] base::Result<std::string> run_watch(const BenchOptions& options, std::int64_t tests);

}  // namespace stickslip::cli
