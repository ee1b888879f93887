/// \file
/// What stickslipd is told to do. config/stickslipd.toml documents each key.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/dated_folders.hpp"
#include "io/fleet_settings.hpp"

#include "core/analysis/kept.hpp"
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
  int priority = 50;             ///< SCHED_FIFO, 1 … 99; 0 does not ask.
  std::optional<int> processor;  ///< The only one to run on; any if absent.
  bool lock_memory = true;
};

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// What the file says about the bench; what it does not say is asked of the source of the scans
/// (a scene and a record know their bench), else model::Tester's and daq::LoadCell's defaults.
struct BenchConfig {
  std::optional<double> sled_mass_kg;
  std::optional<double> gravity_m_per_s2;
  std::optional<double> pull_speed_m_per_s;
  std::optional<double> stiffness_N_per_m;
  std::optional<double> load_cell_gain_N_per_V;
  std::optional<double> load_cell_zero_V;
  std::string characterisation;  ///< Text of the file that `stickslip characterise` wrote; empty: none.
  /// Of `stickslip calibrate`; it has given the load cell above.
  std::optional<record::CalibrationFacts> calibration;
  std::filesystem::path calibration_folder;  ///< Where new ones are kept; empty: nowhere.

  [[nodiscard]] model::Tester tester(const std::optional<model::Tester>& known) const;
  [[nodiscard]] daq::LoadCell load_cell(const std::optional<daq::LoadCell>& known) const;
};

struct DaemonConfig {
  drivers::BoardConfig board;
  std::optional<double> clock_steps_every_s;  ///< Of a simulated bench whose date is put right; none: never.
  double clock_speed = 1.0;  ///< Board time over wall time; for boards that are not hardware.
  RealtimeSettings realtime;
  BenchConfig bench;
  pipeline::SegmenterSettings segmenter;  ///< Its scan rate is the board's.
  bool begins_by_force = true;            ///< Else each test has to be armed or started.
  model::Method method;
  record::SampleFacts sample;
  /// Absent: that of a replayed record, else "fit".
  std::optional<detect::EstimatorTier> estimator;
  analysis::Kept kept;
  std::filesystem::path record_folder;
  DatedFolders dated_folders = DatedFolders::kNone;
  bool read_only_records = false;
  std::optional<std::filesystem::path> control_socket;
  std::string http;                    ///< Address and port of this machine; empty: none.
  std::filesystem::path token_file;    ///< For http.
  std::optional<FleetSettings> fleet;  ///< Nothing: no broker.
  LogLevel log_level = LogLevel::kInfo;
  bool report_table = false;
  std::string text;  ///< The file as it was read, for the records.
};

/// Reads and checks a file. Scenes and records named in it are relative to its folder; the record
/// folder and the control socket to the working directory. Errors: one line (kUsage).
[[nodiscard]] base::Result<DaemonConfig> load_config(const std::filesystem::path& file);

/// The same from settings already parsed. \param folder  of the file.
[[nodiscard]] base::Result<DaemonConfig> read_config(base::Settings settings,
                                                     const std::filesystem::path& folder);

/// Every key that may be written, as dotted paths.
[[nodiscard]] std::vector<std::string> config_keys();

}  // namespace stickslip::io
