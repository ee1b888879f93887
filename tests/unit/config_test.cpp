#include "io/config.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <string>

namespace stickslip::io {
namespace {

using base::Result;
using base::Settings;

const std::string kFile = STICKSLIP_SOURCE_DIR "/config/stickslipd.toml";

Result<DaemonConfig> read(const std::string& text) {
  const Result<Settings> settings = Settings::parse(text, "x.toml");
  if (!settings) return tl::unexpected(settings.error());
  return read_config(*settings, "/etc/stickslip");
}

const std::string kGood = "[board]\ndriver = \"simulated\"\nsimulated.scenes = [\"a.toml\"]\n";

TEST(Config, ShippedFileIsGoodAndNamesExactlyTheKeysThatAreRead) {
  ASSERT_TRUE(load_config(kFile)) << load_config(kFile).error().message;

  std::set<std::string> documented;
  std::ifstream in{kFile};
  std::string table;
  const std::regex header{R"(^\[([a-z_.]+)\].*)"};
  const std::regex key{R"(^(?:# )?([a-z_]+) = .*)"};
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_match(line, match, header)) table = match[1];
    if (std::regex_match(line, match, key)) documented.insert(table + "." + match[1].str());
  }
  const std::vector<std::string> known = config_keys();
  EXPECT_EQ(documented, std::set<std::string>(known.begin(), known.end()));
}

TEST(Config, RecordsMayStandInDatedFoldersReadOnly) {
  EXPECT_EQ(read(kGood)->dated_folders, DatedFolders::kNone);
  EXPECT_FALSE(read(kGood)->read_only_records);
  const auto dated = read(std::string{kGood} + "[record]\ndated_folders = \"day\"\nread_only = true\n");
  ASSERT_TRUE(dated) << dated.error().message;
  EXPECT_EQ(dated->dated_folders, DatedFolders::kDay);
  EXPECT_TRUE(dated->read_only_records);
  EXPECT_FALSE(read(std::string{kGood} + "[record]\ndated_folders = \"year\"\n"));
}

TEST(Config, ABoardIsNamedByItselfOrByItsDeviceFile) {
  const std::string comedi =
      "[board]\ndriver = \"comedi\"\n[tester]\nsled_mass = \"1 kg\"\nload_cell_gain = \"2 "
      "N/V\"\n[board.comedi]\n";
  EXPECT_TRUE(read(comedi)->board.comedi.choice.empty());
  const auto chosen = read(comedi + "board = \"das\"\nserial = \"01A2\"\nbus_path = \"pci-0000:00:05.0\"\n");
  ASSERT_TRUE(chosen) << chosen.error().message;
  const drivers::BoardChoice& choice = chosen->board.comedi.choice;
  EXPECT_EQ(choice.board, "das");
  EXPECT_EQ(choice.serial, "01A2");
  EXPECT_EQ(choice.bus_path, "pci-0000:00:05.0");
}

// The values shown behind "# " are the defaults: with all of them in force nothing changes.
TEST(Config, ShippedFileShowsTheDefaults) {
  std::ifstream in{kFile};
  std::string shown;
  const std::regex key{R"(^# ([a-z_]+ = .*))"};
  // These have no default, or one that cannot be written.
  const std::regex example{
      R"(^# (scan_rate|file|hanging|board|serial|bus_path|subdevice|pull_speed|stiffness|anti_alias|anti_alias_order|load_cell_frequency|load_cell_damping|socket|speed_gain|speed_channel|position_gain|position_channel|load_cell_gain|sled_mass|gravity|load_cell_zero|characterisation|replicate|broker|tester|user|password_file|ca_file|certificate_file|key_file) = .*|^# calibration = "calibrations".*)"};
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    const bool is_default = std::regex_match(line, match, key) && !std::regex_match(line, example);
    shown += (is_default ? match[1].str() : line) + "\n";
  }
  const Result<DaemonConfig> written = read(shown);
  ASSERT_TRUE(written) << written.error().message;
  const DaemonConfig plain = *read(kGood);
  EXPECT_EQ(written->clock_speed, plain.clock_speed);
  EXPECT_EQ(written->realtime.priority, plain.realtime.priority);
  EXPECT_EQ(written->board.simulated.repeats, plain.board.simulated.repeats);
  EXPECT_EQ(written->board.comedi.device, plain.board.comedi.device);
  EXPECT_EQ(written->board.comedi.channel, plain.board.comedi.channel);
  EXPECT_EQ(written->board.comedi.range_min_V, plain.board.comedi.range_min_V);
  EXPECT_EQ(written->board.comedi.range_max_V, plain.board.comedi.range_max_V);
  EXPECT_EQ(written->board.comedi.reference, plain.board.comedi.reference);
  EXPECT_EQ(written->board.comedi.scan_rate_tolerance, plain.board.comedi.scan_rate_tolerance);
  EXPECT_EQ(written->segmenter.start_coefficient, plain.segmenter.start_coefficient);
  EXPECT_EQ(written->segmenter.start_dwell_s, plain.segmenter.start_dwell_s);
  EXPECT_EQ(written->segmenter.pre_trigger_s, plain.segmenter.pre_trigger_s);
  EXPECT_EQ(written->segmenter.end_coefficient, plain.segmenter.end_coefficient);
  EXPECT_EQ(written->segmenter.unload_dwell_s, plain.segmenter.unload_dwell_s);
  EXPECT_EQ(written->segmenter.no_motion_dwell_s, plain.segmenter.no_motion_dwell_s);
  EXPECT_EQ(written->method.name, plain.method.name);
  EXPECT_EQ(written->method.kinetic_cycles, plain.method.kinetic_cycles);
  EXPECT_EQ(written->record_folder, plain.record_folder);
  EXPECT_FALSE(written->fleet);
  EXPECT_EQ(written->log_level, plain.log_level);
  EXPECT_EQ(written->report_table, plain.report_table);
  // That of a replayed record gives way to one that is written, even the default.
  EXPECT_EQ(written->estimator, detect::EstimatorTier::kFit);
  EXPECT_EQ(plain.estimator, std::nullopt);
  EXPECT_EQ(written->skipped, plain.skipped);
}

TEST(Config, EstimatorsOfVersion01MeanTurningPointsWithAWarning) {
  for (const std::string former : {"peak", "interpolated"}) {
    const auto config = read(kGood + "[analysis]\nestimator = \"" + former + "\"\n");
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(config->estimator, detect::EstimatorTier::kTurningPoints);
    ASSERT_EQ(config->warnings.size(), 1U);
    EXPECT_EQ(config->warnings.front(),
              "analysis.estimator = \"" + former +
                  "\": this estimator was removed; write \"turning-points\" or \"fit\"");
  }
  const auto config = read(std::string{kGood} + "[analysis]\nestimator = \"turning-points\"\n");
  EXPECT_EQ(config->estimator, detect::EstimatorTier::kTurningPoints);
  EXPECT_TRUE(config->warnings.empty());
  EXPECT_FALSE(read(std::string{kGood} + "[analysis]\nestimator = \"best\"\n"));
}

TEST(Config, TransducerIsThatOfTheFileElseOfTheRecord) {
  const DaemonConfig config =
      *read(kGood +
            "anti_alias = \"60 Hz\"\n[tester]\nload_cell_frequency = \"120 Hz\"\nload_cell_damping = 0.1\n");
  const model::Transducer& stated = config.bench.transducer;
  EXPECT_EQ(stated.load_cell->frequency_Hz, 120.0);
  EXPECT_EQ(stated.load_cell->damping_ratio, 0.1);
  EXPECT_EQ(stated.anti_alias->cutoff_Hz, 60.0);
  EXPECT_EQ(stated.anti_alias->order, 4);
  model::Tester recorded;
  recorded.transducer.load_cell = {80.0, 0.02};
  EXPECT_EQ(config.bench.tester(recorded).transducer.load_cell->frequency_Hz, 120.0);
  EXPECT_EQ(read(kGood)->bench.tester(recorded).transducer.load_cell->frequency_Hz, 80.0);
  EXPECT_FALSE(read(kGood + "[tester]\nload_cell_frequency = \"120 Hz\"\nload_cell_damping = 1\n"));
  EXPECT_FALSE(read(kGood + "[tester]\nload_cell_damping = 0.05\n")) << "of which cell?";
  EXPECT_FALSE(read(kGood + "anti_alias_order = 4\n")) << "of which filter?";
  EXPECT_FALSE(read(kGood + "[tester]\nload_cell_frequency = \"0 Hz\"\n"));
}

TEST(Config, KeepsWhatItIsTold) {
  EXPECT_TRUE(read(kGood)->skipped.none());
  const DaemonConfig config = *read(kGood + "[analysis]\nkeep_spikes = true\nkeep_first_slip = true\n");
  EXPECT_EQ(analysis::text_of(config.skipped), "spikes,first-slip");
}

TEST(Config, ResolvesScenesAgainstItsOwnFolder) {
  const DaemonConfig config = *read(kGood + "[record]\nfolder = \"r\"\n");
  EXPECT_EQ(config.board.simulated.scenes.front(), "/etc/stickslip/a.toml");
  EXPECT_EQ(config.record_folder, "r");
}

// What the file says stands above what a scene or record knows, and that above the defaults.
TEST(Config, TakesTheBenchFromTheFileThenFromTheSource) {
  const DaemonConfig config = *read(kGood + "[tester]\nsled_mass = \"1 kg\"\n");
  model::Tester scene;
  scene.sled_mass_kg = 3.0;
  scene.pull_speed_m_per_s = 0.005;
  EXPECT_EQ(config.bench.tester(scene).sled_mass_kg, 1.0);
  EXPECT_EQ(config.bench.tester(scene).pull_speed_m_per_s, 0.005);
  EXPECT_EQ(config.bench.tester(std::nullopt).gravity_m_per_s2, model::kStandardGravity_m_per_s2);
  EXPECT_EQ(config.bench.load_cell(daq::LoadCell{2.0, 0.1}).gain_N_per_V, 2.0);
}

struct Mistake {
  const char* text;
  const char* error;
};

class ConfigRefuses : public testing::TestWithParam<Mistake> {};

TEST_P(ConfigRefuses, WithOneLine) {
  const Result<DaemonConfig> config = read(GetParam().text);
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().exit_status(), 2);
  EXPECT_EQ(config.error().message, GetParam().error);
}

#define BOARD "[board]\ndriver = \"simulated\"\nsimulated.scenes = [\"a\"]\n"

INSTANTIATE_TEST_SUITE_P(
    Mistakes, ConfigRefuses,
    testing::Values(
        Mistake{"",
                "x.toml:1: board.driver is missing; it must be one of \"simulated\", \"replay\", \"comedi\""},
        Mistake{"[board]\ndriver = \"comedy\"",
                "x.toml:2: board.driver = \"comedy\": must be one of \"simulated\", \"replay\", \"comedi\""},
        Mistake{BOARD "scan_rate = \"0 Hz\"",
                "x.toml:4: board.scan_rate = \"0 Hz\": must be above 0 Hz and at most 1000000 Hz"},
        Mistake{BOARD "clock_speed = 0",
                "x.toml:4: board.clock_speed = 0: must be above 0 and at most 10000"},
        Mistake{BOARD "[tester]\nsled_mass = \"-2331 g\"",
                "x.toml:5: tester.sled_mass = \"-2331 g\": must be above 0 kg and at most 1000 kg"},
        Mistake{BOARD "[tester]\nload_cell_gain = \"0 N/V\"",
                "x.toml:5: tester.load_cell_gain = \"0 N/V\": must not be 0"},
        Mistake{BOARD "[tester]\ncalibration = \"a\\nb\"",
                "x.toml:5: tester.calibration = \"a\\x0ab\": /etc/stickslip/a\\x0ab: there is no such file"},
        Mistake{BOARD "[test]\nstart = 0.01", "x.toml:4: test.end: must be below start = 0.01"},
        Mistake{BOARD "[method]\nkinetic_cycles = 0",
                "x.toml:5: method.kinetic_cycles = 0: must be an integer from 1 to 1000"},
        Mistake{BOARD "[record]\nfolder = \"\"", "x.toml:5: record.folder = \"\": must name a folder"},
        Mistake{BOARD "[report]\ntable = \"yes\"", "x.toml:5: report.table = \"yes\": must be true or false"},
        Mistake{
            "[board]\ndriver = \"comedi\"\nclock_speed = 2\n[tester]\nsled_mass = \"1 kg\"\nload_cell_gain = "
            "\"1 N/V\"",
            "x.toml:3: board.clock_speed = 2: must be 1 for the driver \"comedi\": hardware keeps its own "
            "time"}));

}  // namespace
}  // namespace stickslip::io
