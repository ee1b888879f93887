#include "io/config.hpp"

#include <array>
#include <optional>
#include <utility>

#include "io/calibration_file.hpp"
#include "io/method_file.hpp"

#include "core/base/text.hpp"
#include "core/model/largest_settings.hpp"
#include "core/record/tester_file.hpp"

namespace stickslip::io {
namespace {

const base::Limits kTransducerFrequencies =
    base::Limits::between(model::kSlowestTransducer_Hz, model::kFastestTransducer_Hz);

using base::Dimension;
using base::Settings;
using drivers::AcquisitionMode;
using drivers::AnalogReference;
using drivers::CalibrationSource;
using drivers::Driver;

constexpr std::array<std::pair<std::string_view, Driver>, 3> kDrivers{
    {{"simulated", Driver::kSimulated}, {"replay", Driver::kReplay}, {"comedi", Driver::kComedi}}};

constexpr std::array<std::pair<std::string_view, AnalogReference>, 4> kReferences{
    {{"ground", AnalogReference::kGround},
     {"common", AnalogReference::kCommon},
     {"differential", AnalogReference::kDifferential},
     {"other", AnalogReference::kOther}}};

constexpr std::array<std::pair<std::string_view, CalibrationSource>, 4> kCalibrations{
    {{"by-flag", CalibrationSource::kByFlag},
     {"soft", CalibrationSource::kSoft},
     {"hard", CalibrationSource::kHard},
     {"none", CalibrationSource::kNone}}};

constexpr std::array<std::pair<std::string_view, AcquisitionMode>, 3> kAcquisitions{
    {{"by-flag", AcquisitionMode::kByFlag},
     {"command", AcquisitionMode::kCommand},
     {"polled", AcquisitionMode::kPolled}}};

constexpr std::array<std::pair<std::string_view, LogLevel>, 4> kLogLevels{{{"debug", LogLevel::kDebug},
                                                                           {"info", LogLevel::kInfo},
                                                                           {"warning", LogLevel::kWarning},
                                                                           {"error", LogLevel::kError}}};

constexpr std::array<std::pair<std::string_view, detect::EstimatorTier>, 2> kEstimators{
    {{detect::name(detect::EstimatorTier::kTurningPoints), detect::EstimatorTier::kTurningPoints},
     {detect::name(detect::EstimatorTier::kFit), detect::EstimatorTier::kFit}}};

constexpr std::array<std::pair<std::string_view, DatedFolders>, 3> kDatedFolders{
    {{"none", DatedFolders::kNone}, {"month", DatedFolders::kMonth}, {"day", DatedFolders::kDay}}};

constexpr std::array<std::pair<std::string_view, bool>, 2> kBeginnings{{{"force", true}, {"command", false}}};

/// Bounds that catch mistyped values. They lie far beyond real testers.
constexpr double kFastestScanRate_Hz = 1e6;
constexpr double kFastestClock = 1e4;
constexpr double kStrongestGravity_m_per_s2 = 100.0;
constexpr double kHighestVoltage_V = 1e3;
constexpr double kLargestCoefficient = 10.0;
constexpr double kLongestDwell_s = 3600.0;
constexpr std::int64_t kMostRepeats = 1'000'000;
constexpr std::int64_t kHighestFirstScan = std::int64_t{1}
                                           << 52;  ///< A double still resolves half a scan there.
constexpr std::int64_t kHighestChannel = 1023;
constexpr std::int64_t kHighestProcessor = 1023;  ///< CPU_SETSIZE − 1

std::filesystem::path resolved(const std::filesystem::path& folder, const std::string& name) {
  return folder / name;  // An absolute name stays as it is.
}

void read_faults(Settings table, DaemonConfig& config) {
  drivers::SimulatedFaults& faults = config.board.simulated.faults;
  // Kinds that come more often than each second leave nothing to measure between them.
  const auto every_s = [&](const char* key) {
    return table.quantity_if_given(key, Dimension::kTime, base::Limits::at_least(1.0));
  };
  faults.overruns_every_s = every_s("overruns_every").value_or(0.0);
  faults.losses_every_s = every_s("losses_every").value_or(0.0);
  config.clock_steps_every_s = every_s("clock_steps_every");
  faults.seed = static_cast<std::uint64_t>(table.integer("seed", 0, kHighestFirstScan, 1));
}

void read_simulated(Settings table, const std::filesystem::path& folder, DaemonConfig& config) {
  const std::vector<std::string> scenes = table.texts("scenes", std::vector<std::string>{});
  if (config.board.driver == Driver::kSimulated && scenes.empty()) {
    table.refuse("scenes", "needs at least one scene file for the driver \"simulated\"");
  }
  for (const std::string& scene : scenes) config.board.simulated.scenes.push_back(resolved(folder, scene));
  config.board.simulated.repeats = static_cast<int>(table.integer("repeats", 0, kMostRepeats, 1));
  config.board.simulated.speed_gain_m_per_s_per_V =
      table.quantity_if_given("speed_gain", Dimension::kSpeedPerVoltage, base::Limits::above(0.0));
  if (const std::string hanging = table.text("hanging", ""); !hanging.empty())
    config.board.simulated.hanging = resolved(folder, hanging);
  config.board.simulated.first_scan = table.integer("first_scan", 0, kHighestFirstScan, 0);
  read_faults(table.table("faults"), config);
}

void read_replay(Settings table, const std::filesystem::path& folder, DaemonConfig& config) {
  const std::string file = table.text("file", "");
  if (config.board.driver == Driver::kReplay && file.empty()) {
    table.refuse("file", "needs a record file for the driver \"replay\"");
  }
  config.board.replay_file = resolved(folder, file);
}

/// Reads the settings of the second channel: speed or position.
std::optional<drivers::SecondInputSettings> read_second(Settings& table) {
  drivers::SecondInputSettings second;
  const base::Limits voltages = base::Limits::between(-kHighestVoltage_V, kHighestVoltage_V);
  second.range_min_V = table.quantity("second_range_min", Dimension::kVoltage, voltages, second.range_min_V);
  second.range_max_V = table.quantity("second_range_max", Dimension::kVoltage, voltages, second.range_max_V);
  if (!(second.range_max_V > second.range_min_V)) {
    table.refuse("second_range_max", "must be above second_range_min");
  }
  bool found = false;
  const auto read = [&](const std::string& what, Dimension gain, daq::SecondQuantity quantity,
                        const char* example) {
    const std::string channel_key = what + "_channel";
    const std::string gain_key = what + "_gain";
    const bool given = table.has(channel_key);
    const auto channel = static_cast<unsigned>(table.integer(channel_key, 0, kHighestChannel, 1));
    const auto gain_per_V = table.quantity_if_given(gain_key, gain, base::Limits::any());
    const double zero_V = table.quantity(what + "_zero", Dimension::kVoltage, voltages, 0.0);
    if (!given) return;
    if (found) table.refuse(channel_key, "cannot be read beside speed_channel: one second channel is all");
    if (!gain_per_V) {
      table.refuse(gain_key,
                   fmt::format("is missing; hardware cannot know it: give it, such as \"{}\"", example));
    } else if (*gain_per_V == 0.0) {
      table.refuse(gain_key, "must not be 0");
    }
    found = true;
    second.quantity = quantity;
    second.channel = channel;
    second.gain_per_V = gain_per_V.value_or(1.0);
    second.zero_V = zero_V;
  };
  read("speed", Dimension::kSpeedPerVoltage, daq::SecondQuantity::kPullSpeed, "1 mm/s/V");
  read("position", Dimension::kLengthPerVoltage, daq::SecondQuantity::kSledPosition, "20 mm/V");
  return found ? std::optional{second} : std::nullopt;
}

void read_comedi(Settings table, DaemonConfig& config) {
  drivers::ComediBoardSettings& comedi = config.board.comedi;
  comedi.device = table.text("device", comedi.device);
  comedi.choice = {table.text("board", ""), table.text("serial", ""), table.text("bus_path", "")};
  // Absent: the board's first analog input.
  if (table.has("subdevice")) {
    comedi.subdevice = static_cast<unsigned>(table.integer("subdevice", 0, kHighestChannel));
  } else {
    static_cast<void>(table.integer("subdevice", 0, kHighestChannel, 0));
  }
  comedi.channel = static_cast<unsigned>(table.integer("channel", 0, kHighestChannel, comedi.channel));
  const base::Limits voltages = base::Limits::between(-kHighestVoltage_V, kHighestVoltage_V);
  comedi.range_min_V = table.quantity("range_min", Dimension::kVoltage, voltages, comedi.range_min_V);
  comedi.range_max_V = table.quantity("range_max", Dimension::kVoltage, voltages, comedi.range_max_V);
  if (!(comedi.range_max_V > comedi.range_min_V)) table.refuse("range_max", "must be above range_min");
  comedi.second = read_second(table);
  comedi.reference = table.choice<AnalogReference>("reference", kReferences, comedi.reference);
  comedi.calibration = table.choice<CalibrationSource>("calibration", kCalibrations, comedi.calibration);
  comedi.acquisition = table.choice<AcquisitionMode>("acquisition", kAcquisitions, comedi.acquisition);
  comedi.scan_rate_tolerance = table.quantity("scan_rate_tolerance", Dimension::kDimensionless,
                                              base::Limits::between(0.0, 1.0), comedi.scan_rate_tolerance);
}

void read_board(Settings table, const std::filesystem::path& folder, DaemonConfig& config) {
  config.board.driver = table.choice<Driver>("driver", kDrivers);
  const std::optional<double> scan_rate_Hz = table.quantity_if_given(
      "scan_rate", Dimension::kFrequency, base::Limits::above_up_to(0.0, kFastestScanRate_Hz));
  config.board.simulated.scan_rate_Hz = scan_rate_Hz;
  const auto anti_alias_Hz =
      table.quantity_if_given("anti_alias", Dimension::kFrequency, kTransducerFrequencies);
  const auto order = static_cast<int>(
      table.integer("anti_alias_order", 1, model::AntiAlias::kHighestOrder, model::kTypicalFilterOrder));
  if (anti_alias_Hz) config.bench.transducer.anti_alias = {*anti_alias_Hz, order};
  if (!anti_alias_Hz && table.has("anti_alias_order"))
    table.refuse("anti_alias_order", "needs anti_alias, such as \"60 Hz\"");
  config.board.comedi.scan_rate_Hz = scan_rate_Hz.value_or(config.board.comedi.scan_rate_Hz);
  config.clock_speed = table.quantity("clock_speed", Dimension::kDimensionless,
                                      base::Limits::above_up_to(0.0, kFastestClock), config.clock_speed);
  if (config.board.driver == Driver::kComedi && config.clock_speed != 1.0) {
    table.refuse("clock_speed", "must be 1 for the driver \"comedi\": hardware keeps its own time");
  }
  config.realtime.priority =
      static_cast<int>(table.integer("realtime_priority", 0, 99, config.realtime.priority));
  config.realtime.lock_memory = table.boolean("lock_memory", config.realtime.lock_memory);
  if (table.has("processor")) {
    config.realtime.processor = static_cast<int>(table.integer("processor", 0, kHighestProcessor));
  } else {
    static_cast<void>(table.integer("processor", 0, kHighestProcessor, 0));
  }
  read_simulated(table.table("simulated"), folder, config);
  read_replay(table.table("replay"), folder, config);
  read_comedi(table.table("comedi"), config);
}

void read_calibration(Settings& table, const std::filesystem::path& path, BenchConfig& bench) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored) || path.extension() != ".toml") {
    bench.calibration_folder = path;
    // The gain of the data sheet holds until the first calibration is there, which may come while it is read.
    if (table.has("load_cell_gain") && !holds_calibration(path)) return;
  } else {
    for (const char* key : {"load_cell_gain", "load_cell_zero"}) {
      if (table.has(key)) table.refuse(key, "stands in the calibration");
    }
  }
  const base::Result<StoredCalibration> stored = load_calibration(path);
  if (!stored) {
    table.refuse("calibration", stored.error().message);
    return;
  }
  bench.load_cell_gain_N_per_V = stored->load_cell.gain_N_per_V;
  bench.load_cell_zero_V = stored->load_cell.zero_V;
  bench.calibration = stored->facts;
}

void read_sample(Settings table, record::SampleFacts& sample) {
  const auto name = [&table](const char* key) {
    std::string text = table.text(key, "");
    if (const std::string why = base::name_refusal(text); !why.empty()) table.refuse(key, why);
    return text;
  };
  sample.name = name("name");
  sample.grade = name("grade");
  sample.direction = name("direction");
  sample.side = name("side");
  constexpr std::int64_t kMostReplicates = 1'000'000;
  const std::int64_t replicate = table.integer("replicate", 1, kMostReplicates, 1);
  if (table.has("replicate")) sample.replicate = replicate;
  sample.operator_name = name("operator");
  for (const std::string& fact : table.texts("facts", std::vector<std::string>{})) {
    const auto pair = record::split_fact(fact);
    const auto set = pair ? record::set_fact(sample.metadata, pair->first, pair->second)
                          : base::Result<void>{tl::unexpected(pair.error())};
    if (!set) table.refuse("facts", set.error().message);
  }
}

void read_tester(Settings table, const std::filesystem::path& folder, DaemonConfig& config) {
  BenchConfig& bench = config.bench;
  bench.sled_mass_kg = table.quantity_if_given("sled_mass", Dimension::kMass,
                                               base::Limits::above_up_to(0.0, model::kHeaviestSled_kg));
  bench.gravity_m_per_s2 = table.quantity_if_given(
      "gravity", Dimension::kAcceleration, base::Limits::above_up_to(0.0, kStrongestGravity_m_per_s2));
  bench.pull_speed_m_per_s = table.quantity_if_given(
      "pull_speed", Dimension::kSpeed, base::Limits::above_up_to(0.0, model::kFastestPull_m_per_s));
  bench.stiffness_N_per_m =
      table.quantity_if_given("stiffness", Dimension::kStiffness, base::Limits::above(0.0));
  const auto cell_frequency_Hz =
      table.quantity_if_given("load_cell_frequency", Dimension::kFrequency, kTransducerFrequencies);
  const double cell_damping =
      table.quantity("load_cell_damping", Dimension::kDimensionless,
                     base::Limits::between(0.0, model::kLargestCellDamping), model::kTypicalCellDamping);
  if (cell_frequency_Hz) bench.transducer.load_cell = {*cell_frequency_Hz, cell_damping};
  if (!cell_frequency_Hz && table.has("load_cell_damping"))
    table.refuse("load_cell_damping", "needs load_cell_frequency, such as \"120 Hz\"");
  bench.load_cell_gain_N_per_V =
      table.quantity_if_given("load_cell_gain", Dimension::kForcePerVoltage, base::Limits::any());
  if (bench.load_cell_gain_N_per_V == 0.0) table.refuse("load_cell_gain", "must not be 0");
  const std::string calibration = table.text("calibration", "");
  if (config.board.driver == Driver::kComedi && !table.has("load_cell_gain") && calibration.empty()) {
    table.refuse("load_cell_gain",
                 "is missing; hardware cannot know it: give it, such as \"2 N/V\", or a calibration");
  }
  if (config.board.driver == Driver::kComedi && !table.has("sled_mass")) {
    table.refuse("sled_mass", "is missing; hardware cannot know it: give it, such as \"2331 g\"");
  }
  bench.load_cell_zero_V = table.quantity_if_given(
      "load_cell_zero", Dimension::kVoltage, base::Limits::between(-kHighestVoltage_V, kHighestVoltage_V));
  if (!calibration.empty()) read_calibration(table, resolved(folder, calibration), bench);
  if (const std::string file = table.text("characterisation", ""); !file.empty()) {
    const base::Result<Settings> read = Settings::load(resolved(folder, file));
    if (!read) {
      table.refuse("characterisation", read.error().message);
    } else if (const auto parsed = record::parse_tester(read->source_text(), file); !parsed) {
      table.refuse("characterisation", parsed.error().message);
    } else {
      bench.characterisation = read->source_text();
    }
  }
}

void read_test(Settings table, DaemonConfig& config) {
  config.begins_by_force = table.choice<bool>("begins", kBeginnings, config.begins_by_force);
  pipeline::SegmenterSettings& segmenter = config.segmenter;
  const base::Limits coefficient = base::Limits::between(0.0, kLargestCoefficient);
  const base::Limits dwell = base::Limits::above_up_to(0.0, kLongestDwell_s);
  segmenter.start_coefficient =
      table.quantity("start", Dimension::kDimensionless, coefficient, segmenter.start_coefficient);
  segmenter.start_dwell_s = table.quantity("start_dwell", Dimension::kTime, dwell, segmenter.start_dwell_s);
  segmenter.pre_trigger_s = table.quantity(
      "pre_trigger", Dimension::kTime, base::Limits::between(0.0, kLongestDwell_s), segmenter.pre_trigger_s);
  segmenter.end_coefficient =
      table.quantity("end", Dimension::kDimensionless, coefficient, segmenter.end_coefficient);
  segmenter.unload_dwell_s = table.quantity("end_dwell", Dimension::kTime, dwell, segmenter.unload_dwell_s);
  segmenter.no_motion_dwell_s =
      table.quantity("no_motion_dwell", Dimension::kTime, dwell, segmenter.no_motion_dwell_s);
  if (!(segmenter.end_coefficient < segmenter.start_coefficient)) {
    table.refuse("end", fmt::format("must be below start = {}", segmenter.start_coefficient));
  }
}

void read_method(Settings table, const std::filesystem::path& folder, model::Method& method) {
  if (const std::string file = table.text("file", ""); !file.empty()) {
    for (const char* key : {"name", "kinetic_cycles"}) {
      if (table.has(key)) table.refuse(key, "stands in the method's file");
    }
    const base::Result<MethodFile> read = load_method(folder / file);
    if (read) {
      method = read->method;
    } else {
      table.refuse("file", read.error().message);
    }
  }
  method.name = table.text("name", method.name);
  if (method.name.empty() || method.name.find(' ') != std::string::npos) {
    table.refuse("name", "must be a word without blanks");
  }
  method.kinetic_cycles =
      static_cast<int>(table.integer("kinetic_cycles", 1, kMostKineticCycles, method.kinetic_cycles));
}

/// "peak" and "interpolated" of version 0.1 are accepted, with a warning.
void read_estimator(Settings table, DaemonConfig& config) {
  if (const std::string text = table.text("estimator", ""); detect::is_former_estimator(text)) {
    config.estimator = detect::EstimatorTier::kTurningPoints;
    config.warnings.push_back(fmt::format(
        "analysis.estimator = \"{}\": this estimator was removed; write \"turning-points\" or \"fit\"",
        text));
    return;
  }
  const auto estimator =
      table.choice<detect::EstimatorTier>("estimator", kEstimators, detect::EstimatorTier::kFit);
  if (table.has("estimator")) config.estimator = estimator;
}

DaemonConfig read_all(Settings& settings, const std::filesystem::path& folder) {
  DaemonConfig config;
  read_board(settings.table("board"), folder, config);
  read_tester(settings.table("tester"), folder, config);
  read_test(settings.table("test"), config);
  read_sample(settings.table("sample"), config.sample);
  read_method(settings.table("method"), folder, config.method);
  config.board.simulated.method = config.method;
  Settings trend = settings.table("trend");
  config.trend_reference = trend.text("reference", "");
  if (const std::string why = base::name_refusal(config.trend_reference); !why.empty())
    trend.refuse("reference", why);
  Settings analysis = settings.table("analysis");
  read_estimator(analysis, config);
  config.skipped = {.spikes = analysis.boolean("keep_spikes", false),
                    .drift = analysis.boolean("keep_drift", false),
                    .first_slip = analysis.boolean("keep_first_slip", false)};
  Settings record = settings.table("record");
  config.record_folder = record.text("folder", "records");
  if (config.record_folder.empty()) record.refuse("folder", "must name a folder");
  config.dated_folders = record.choice<DatedFolders>("dated_folders", kDatedFolders, config.dated_folders);
  config.read_only_records = record.boolean("read_only", config.read_only_records);
  Settings control = settings.table("control");
  if (const std::string socket = control.text("socket", ""); !socket.empty()) config.control_socket = socket;
  config.http = control.text("http", "");
  config.token_file = control.text("token_file", "");
  if (!config.http.empty() && config.token_file.empty()) {
    control.refuse("token_file", "is missing: who comes over http has to show the token that stands there");
  }
  config.fleet = read_fleet(settings.table("fleet"), folder);
  config.log_level = settings.table("log").choice<LogLevel>("level", kLogLevels, config.log_level);
  config.report_table = settings.table("report").boolean("table", config.report_table);
  config.text = settings.source_text();
  return config;
}

}  // namespace

model::Tester BenchConfig::tester(const std::optional<model::Tester>& known) const {
  model::Tester tester = known.value_or(model::Tester{});
  tester.sled_mass_kg = sled_mass_kg.value_or(tester.sled_mass_kg);
  tester.gravity_m_per_s2 = gravity_m_per_s2.value_or(tester.gravity_m_per_s2);
  if (pull_speed_m_per_s) tester.pull_speed_m_per_s = pull_speed_m_per_s;
  if (stiffness_N_per_m) tester.stiffness_N_per_m = stiffness_N_per_m;
  if (transducer.load_cell) tester.transducer.load_cell = transducer.load_cell;
  if (transducer.anti_alias) tester.transducer.anti_alias = transducer.anti_alias;
  return tester;
}

daq::LoadCell BenchConfig::load_cell(const std::optional<daq::LoadCell>& known) const {
  daq::LoadCell cell = known.value_or(daq::LoadCell{});
  cell.gain_N_per_V = load_cell_gain_N_per_V.value_or(cell.gain_N_per_V);
  cell.zero_V = load_cell_zero_V.value_or(cell.zero_V);
  return cell;
}

base::Result<DaemonConfig> read_config(Settings settings, const std::filesystem::path& folder) {
  DaemonConfig config = read_all(settings, folder);
  if (base::Result<void> finished = settings.finish(); !finished) return tl::unexpected(finished.error());
  return config;
}

base::Result<DaemonConfig> load_config(const std::filesystem::path& file) {
  base::Result<Settings> settings = Settings::load(file);
  if (!settings) return tl::unexpected(settings.error());
  return read_config(*settings, file.parent_path());
}

std::vector<std::string> config_keys() {
  base::Result<Settings> empty = Settings::parse("", "");
  static_cast<void>(read_all(*empty, {}));
  return empty->known_keys();
}

}  // namespace stickslip::io
