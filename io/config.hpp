/// \file
/// The configuration of stickslipd. config/stickslipd.toml documents each key.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/dated_folders.hpp"
#include "io/fleet_settings.hpp"

#include "core/analysis/skipped_corrections.hpp"
#include "core/base/result.hpp"
#include "core/base/settings.hpp"
#include "core/daq/calibration.hpp"
#include "core/detect/live_cycle.hpp"
#include "core/model/method.hpp"
#include "core/model/tester.hpp"
#include "core/pipeline/segmenter.hpp"
#include "core/record/record.hpp"
#include "drivers/factory/board_config.hpp"

namespace stickslip::io {

/// What the acquisition thread asks of the kernel.
struct RealtimeSettings {
  int priority = 50;             ///< Of SCHED_FIFO, 1 … 99; 0: ordinary scheduling.
  std::optional<int> processor;  ///< Runs on this one only; absent: on any.
  bool lock_memory = true;
};

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// What the file says about the bench. An absent value is taken from the source of the scans (a scene and a
/// record know their bench), else it is the default of model::Tester or daq::LoadCell.
struct BenchConfig {
  std::optional<double> sled_mass_kg;
  std::optional<double> gravity_m_per_s2;
  std::optional<double> pull_speed_m_per_s;
  std::optional<double> stiffness_N_per_m;
  model::Transducer transducer;  ///< Ideal: none is stated.
  std::optional<double> load_cell_gain_N_per_V;
  std::optional<double> load_cell_zero_V;
  std::string characterisation;  ///< Text of the file that `stickslip characterise` wrote; empty: none.
  /// The calibration file that gave the gain and zero above; absent if the configuration gave them.
  std::optional<record::CalibrationFacts> calibration;
  std::filesystem::path calibration_folder;  ///< Where new calibrations are stored; empty: nowhere.

  [[nodiscard]] model::Tester tester(const std::optional<model::Tester>& known) const;
  [[nodiscard]] daq::LoadCell load_cell(const std::optional<daq::LoadCell>& known) const;
};

struct DaemonConfig {
  drivers::BoardConfig board;
  /// A simulated bench's date is stepped at this interval, by up to 1 h; absent: never.
  std::optional<double> clock_steps_every_s;
  double clock_speed = 1.0;  ///< Board time over wall time; for boards that are not hardware.
  RealtimeSettings realtime;
  BenchConfig bench;
  pipeline::SegmenterSettings segmenter;  ///< Its scan rate is the board's.
  bool begins_by_force = true;            ///< False: each test must be armed or started by command.
  model::Method method;
  record::SampleFacts sample;
  /// Absent: that of a replayed record, else "fit".
  std::optional<detect::EstimatorTier> estimator;
  analysis::SkippedCorrections skipped;
  std::string trend_reference;  ///< Name of the sample that is the reference paper; empty: none.
  std::filesystem::path record_folder;
  DatedFolders dated_folders = DatedFolders::kNone;
  bool read_only_records = false;
  std::optional<std::filesystem::path> control_socket;
  std::string http;                    ///< Address and port on this machine; empty: no TCP port.
  std::filesystem::path token_file;    ///< File of the token that clients over TCP must send.
  std::optional<FleetSettings> fleet;  ///< Absent: no broker.
  LogLevel log_level = LogLevel::kInfo;
  bool report_table = false;
  std::string text;                   ///< The file's text, stored in each record.
  std::vector<std::string> warnings;  ///< Outdated words in the file, each with the word to write.
};

/// Reads and checks a configuration file. Paths of scenes and records in it are relative to its folder; those
/// of the record folder and the control socket to the working directory. Errors: kUsage, one line.
[[nodiscard]] base::Result<DaemonConfig> load_config(const std::filesystem::path& file);

/// As load_config(), from parsed settings. \param folder  of the configuration file.
[[nodiscard]] base::Result<DaemonConfig> read_config(base::Settings settings,
                                                     const std::filesystem::path& folder);

/// Every key that may be written, as dotted paths.
[[nodiscard]] std::vector<std::string> config_keys();

}  // namespace stickslip::io
