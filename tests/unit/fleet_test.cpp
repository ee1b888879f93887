#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/config.hpp"
#include "io/own_records.hpp"

#include "daemon/fleet/backlog.hpp"
#include "daemon/fleet/outbox.hpp"

namespace stickslip::io {
namespace {

namespace fs = std::filesystem;

base::Result<DaemonConfig> read_fleet(const std::string& fleet) {
  const auto settings = base::Settings::parse(
      "[board]\ndriver = \"simulated\"\nsimulated.scenes = [\"a.toml\"]\n[fleet]\n" + fleet, "x.toml");
  if (!settings) return tl::unexpected(settings.error());
  return read_config(*settings, "/etc/stickslip");
}

TEST(FleetSettings, ReadWhatIsSaid) {
  EXPECT_FALSE(read_fleet("")->fleet);
  const auto config = read_fleet(R"(broker = "mqtts://broker.plant"
tester = "bench-7"
topic = "mill/paper-lab"
user = "b7"
password_file = "pw"
ca_file = "/etc/ssl/ca.pem"
outbox_results = 5
health_period = "1 min"
)");
  ASSERT_TRUE(config) << config.error().message;
  const FleetSettings& fleet = *config->fleet;
  EXPECT_EQ(fleet.broker, (Broker{"broker.plant", 8883, true}));
  EXPECT_EQ(fleet.topic_of("state"), "mill/paper-lab/bench-7/state");
  EXPECT_EQ(fleet.password_file, "/etc/stickslip/pw");
  EXPECT_EQ(fleet.ca_file, "/etc/ssl/ca.pem");
  EXPECT_EQ(fleet.outbox_results, 5U);
  EXPECT_EQ(fleet.health_period_s, 60.0);
}

// The values that config/stickslipd.toml shows as defaults.
TEST(FleetSettings, DefaultsAreThoseThatTheShippedFileShows) {
  const FleetSettings fleet = *read_fleet("broker = \"mqtt://b\"\ntester = \"t\"\n")->fleet;
  const FleetSettings shown = *read_fleet(R"(broker = "mqtt://b"
tester = "t"
topic = "stickslip"
outbox = "outbox"
outbox_results = 1000
health_period = "10 s"
)")
                                   ->fleet;
  EXPECT_EQ(fleet.topic, shown.topic);
  EXPECT_EQ(fleet.outbox, shown.outbox);
  EXPECT_EQ(fleet.outbox_results, shown.outbox_results);
  EXPECT_EQ(fleet.health_period_s, shown.health_period_s);
  EXPECT_EQ(fleet.broker, (Broker{"b", 1883, false}));
  std::ifstream in{STICKSLIP_SOURCE_DIR "/config/stickslipd.toml"};
  const std::string text{std::istreambuf_iterator<char>{in}, {}};
  for (const char* line : {"# topic = \"stickslip\"", "# outbox = \"outbox\"", "# outbox_results = 1000",
                           "# health_period = \"10 s\""})
    EXPECT_THAT(text, testing::HasSubstr(line));
}

TEST(FleetSettings, BrokersOfAllSpellings) {
  EXPECT_EQ(*parse_broker("mqtt://10.0.0.7:1884"), (Broker{"10.0.0.7", 1884, false}));
  EXPECT_EQ(*parse_broker("mqtts://[fe80::1]:8884"), (Broker{"fe80::1", 8884, true}));
  EXPECT_EQ(*parse_broker("mqtt://[::1]"), (Broker{"::1", 1883, false}));
  for (const char* wrong :
       {"", "broker", "http://b", "mqtt://", "mqtt://b:", "mqtt://b:0", "mqtt://b:65536", "mqtt://b:1x",
        "mqtt://b/x", "mqtt://[::1", "mqtt://[]", "mqtt://[::1]x", "mqtt://b c", "mqtt://u:p@b", "MQTT://b"})
    EXPECT_FALSE(parse_broker(wrong)) << wrong;
}

struct FleetMistake {
  const char* text;
  const char* error;
};

class FleetRefuses : public testing::TestWithParam<FleetMistake> {};

TEST_P(FleetRefuses, WithOneLine) {
  const auto config = read_fleet(GetParam().text);
  ASSERT_FALSE(config);
  EXPECT_EQ(config.error().exit_status(), 2);
  EXPECT_EQ(config.error().message, GetParam().error);
}

#define BROKER "broker = \"mqtt://b\"\n"
#define TESTER "tester = \"t\"\n"
INSTANTIATE_TEST_SUITE_P(
    Mistakes, FleetRefuses,
    testing::Values(
        FleetMistake{
            "broker = \"b\"\n" TESTER,
            "x.toml:5: fleet.broker = \"b\": must be mqtt://HOST, mqtts://HOST for TLS, or one of the two "
            "with :PORT after it"},
        FleetMistake{
            "broker = \"mqtt://b:99999\"\n" TESTER,
            "x.toml:5: fleet.broker = \"mqtt://b:99999\": the port must be a number from 1 to 65535"},
        FleetMistake{
            BROKER,
            "x.toml:4: fleet.tester: is missing: what is this tester called among those at the broker?"},
        FleetMistake{BROKER "tester = \"a/b\"",
                     "x.toml:6: fleet.tester = \"a/b\": must be 1 to 64 letters, digits, - _ ."},
        FleetMistake{
            BROKER TESTER "topic = \"a/#\"",
            "x.toml:7: fleet.topic = \"a/#\": must be words of letters, digits, - _ . with single slashes "
            "between them, at most 200 bytes"},
        FleetMistake{
            BROKER TESTER "user = \"u\"\npassword_file = \"p\"",
            "x.toml:5: fleet.broker = \"mqtt://b\": must be mqtts:// where a password is sent to another "
            "machine"},
        FleetMistake{"broker = \"mqtts://b\"\n" TESTER "password_file = \"p\"",
                     "x.toml:4: fleet.user: is missing: a password alone is nobody's"},
        FleetMistake{BROKER TESTER "ca_file = \"p\"",
                     "x.toml:5: fleet.broker = \"mqtt://b\": must be mqtts:// where certificates are named"},
        FleetMistake{"broker = \"mqtts://b\"\n" TESTER "certificate_file = \"p\"",
                     "x.toml:4: fleet.key_file: is missing: a certificate and its key go together"},
        FleetMistake{BROKER TESTER "outbox_results = 0",
                     "x.toml:7: fleet.outbox_results = 0: must be an integer from 1 to 100000"},
        FleetMistake{BROKER TESTER "health_period = \"0.5 s\"",
                     "x.toml:7: fleet.health_period = \"0.5 s\": must be from 1 s to 3600 s"},
        FleetMistake{BROKER TESTER "outbox = \"\"", "x.toml:7: fleet.outbox = \"\": must name a folder"}));

class Folder : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::path{testing::TempDir()} /
            (std::string{"fleet-"} + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  void TearDown() override { fs::remove_all(path_); }
  fs::path path_;
};

using Password = Folder;

TEST_F(Password, ComesFromAFileThatNotEverybodyReadsAndIsInNoMessage) {
  const fs::path file = path_ / "pw";
  EXPECT_EQ(*read_password(""), std::nullopt);
  EXPECT_EQ(read_password(file).error().kind, base::ErrorKind::kFailure);
  std::ofstream{file} << "hush hush\nsecond line\n";
  ::chmod(file.c_str(), 0640);
  EXPECT_EQ(read_password(file)->value(), "hush hush");
  ::chmod(file.c_str(), 0644);
  const auto open_to_all = read_password(file);
  ASSERT_FALSE(open_to_all);
  EXPECT_EQ(open_to_all.error().kind, base::ErrorKind::kUsage);
  EXPECT_THAT(open_to_all.error().message, testing::Not(testing::HasSubstr("hush")));
  std::ofstream{file} << "\n";
  ::chmod(file.c_str(), 0600);
  EXPECT_EQ(read_password(file).error().kind, base::ErrorKind::kUsage);
}

using OutboxTest = Folder;

fleet::FleetResult numbered(int number) {
  return {fmt::format("20261122T100000Z-{:04}", number), fmt::format("id-{}", number),
          fmt::format("{{\"number\": {}}}", number)};
}

std::vector<std::string> ids(const fleet::Outbox& outbox) {
  std::vector<std::string> ids;
  for (const fleet::FleetResult& result : outbox.results()) ids.push_back(result.id);
  return ids;
}

TEST_F(OutboxTest, KeepsWhatTheBrokerHasNotGotOverTheEndOfTheProgram) {
  {
    fleet::Outbox outbox{path_ / "out", 10};
    for (int i = 1; i <= 3; ++i) EXPECT_TRUE(outbox.add(numbered(i)).is_new);
    EXPECT_FALSE(outbox.add(numbered(2)).is_new) << "the same test twice";
    EXPECT_TRUE(outbox.remove("id-2"));
    EXPECT_FALSE(outbox.remove("id-2"));
    EXPECT_EQ(outbox.unsaved_count(), 0U);
  }
  std::ofstream{path_ / "out" / "20261122T100000Z-0009_id-9.json"} << "{\"torn";
  std::ofstream{path_ / "out" / "notes.txt"} << "somebody's";
  fleet::Outbox again{path_ / "out", 10};
  EXPECT_THAT(ids(again), testing::ElementsAre("id-1", "id-3"));
  EXPECT_EQ(again.results()[1].payload, numbered(3).payload);
  EXPECT_TRUE(fs::exists(path_ / "out" / "notes.txt"));
}

TEST_F(OutboxTest, IsBoundedAndDropsTheOldest) {
  fleet::Outbox outbox{path_, 3};
  for (int i = 1; i <= 3; ++i) EXPECT_FALSE(outbox.add(numbered(i)).dropped);
  EXPECT_TRUE(outbox.add(numbered(4)).dropped);
  EXPECT_THAT(ids(outbox), testing::ElementsAre("id-2", "id-3", "id-4"));
  EXPECT_FALSE(fs::exists(path_ / ("000000000001_" + numbered(1).record + "_id-1.json")));
  EXPECT_TRUE(fs::exists(path_ / ("000000000002_" + numbered(2).record + "_id-2.json")));
  EXPECT_THAT(ids(fleet::Outbox(path_, 2)), testing::ElementsAre("id-3", "id-4"))
      << "a bound that was lowered";
}

// A disk that refuses: what is where the folder should be is a file.
TEST_F(OutboxTest, KeepsInMemoryWhatTheDiskRefusesAndSavesItLater) {
  std::ofstream{path_ / "out"} << "";
  fleet::Outbox outbox{path_ / "out", 2};
  EXPECT_TRUE(outbox.add(numbered(1)).is_new);
  EXPECT_TRUE(outbox.add(numbered(2)).is_new);
  EXPECT_EQ(outbox.unsaved_count(), 2U);
  EXPECT_TRUE(outbox.add(numbered(3)).dropped);
  EXPECT_THAT(ids(outbox), testing::ElementsAre("id-2", "id-3"));
  fs::remove(path_ / "out");
  fs::create_directory(path_ / "out");
  EXPECT_TRUE(outbox.remove("id-2"));
  outbox.add(numbered(4));
  EXPECT_EQ(outbox.unsaved_count(), 0U);
  EXPECT_THAT(ids(fleet::Outbox(path_ / "out", 9)), testing::ElementsAre("id-3", "id-4"));
}

/// A record of that name, as the folder would list it.
fs::path record_called(const std::string& name) { return fs::path{"records"} / (name + ".h5"); }

constexpr const char* kNow = "20261126T000000Z-0000";

// The clock was ten years ahead for a while, and is right again: what is told, what waits and in which order
// does not follow from the names.
TEST_F(OutboxTest, AClockThatWasOnceAheadSilencesNobody) {
  const fleet::FleetResult ahead{"20361122T100000Z-0001", "id-1", "{}"};
  const fleet::FleetResult back{"20261123T100000Z-0002", "id-2", "{}"};
  {
    fleet::Outbox outbox{path_, 10};
    EXPECT_TRUE(outbox.untold({}, kNow).empty());
    outbox.add(ahead);
    outbox.add(back);
  }
  fleet::Outbox again{path_, 10};
  EXPECT_THAT(ids(again), testing::ElementsAre("id-1", "id-2")) << "the order of the tests";
  again.remove("id-1");
  const fs::path killed = record_called("20261123T110000Z-0003");
  const std::vector<fs::path> records{record_called(back.record), killed, record_called(ahead.record)};
  EXPECT_THAT(again.untold(records, kNow), testing::ElementsAre(killed));
}

TEST_F(OutboxTest, ANewOneBeginsWithTheTestsToCome) {
  fleet::Outbox outbox{path_, 10};
  const fs::path past = record_called("20261122T100000Z-0001");
  const fs::path later = record_called("20261121T100000Z-0001");
  EXPECT_TRUE(outbox.untold({past}, kNow).empty());
  EXPECT_THAT(outbox.untold({later, past}, kNow), testing::ElementsAre(later));
}

// As former versions left it: files without a number, and `newest`.
TEST_F(OutboxTest, FolderOfAFormerVersionIsGoneOnWith) {
  std::ofstream{path_ / (numbered(2).record + "_id-2.json")} << numbered(2).payload;
  std::ofstream{path_ / (numbered(1).record + "_id-1.json")} << numbered(1).payload;
  std::ofstream{path_ / "newest"} << numbered(2).record << '\n';
  fleet::Outbox outbox{path_, 10};
  const fs::path untold = record_called(numbered(3).record);
  const std::vector<fs::path> records{record_called(numbered(1).record), record_called(numbered(2).record),
                                      untold};
  EXPECT_THAT(outbox.untold(records, kNow), testing::ElementsAre(untold));
  EXPECT_FALSE(fs::exists(path_ / "newest"));
  outbox.add({"20201122T100000Z-0003", "id-3", "{}"});
  EXPECT_THAT(ids(fleet::Outbox(path_, 10)), testing::ElementsAre("id-1", "id-2", "id-3"));
}

// Its `newest` was set by a clock ahead of today's: it says of no record that it was told.
TEST_F(OutboxTest, NewestOfAClockAheadSaysNothing) {
  std::ofstream{path_ / "newest"} << "20361122T100000Z-0001\n";
  const std::vector<fs::path> records{record_called(numbered(1).record)};
  EXPECT_EQ(fleet::Outbox(path_, 10).untold(records, kNow), records);
}

TEST_F(OutboxTest, NamesOfRecordsThatAreGoneAreForgottenOnceTheyAreMany) {
  fleet::Outbox outbox{path_, 10};
  std::vector<fs::path> records;
  for (int i = 0; i < 3000; ++i) records.push_back(record_called(numbered(i).record));
  EXPECT_TRUE(outbox.untold(records, kNow).empty());
  const auto size = fs::file_size(path_ / "told");
  EXPECT_TRUE(outbox.untold({}, kNow).empty());
  EXPECT_EQ(fs::file_size(path_ / "told"), size) << "the folder was away";
  records.resize(10);
  EXPECT_TRUE(outbox.untold(records, kNow).empty());
  EXPECT_EQ(fs::file_size(path_ / "told"), size / 300);
  EXPECT_TRUE(outbox.untold(records, kNow).empty());
}

// A power cut in the middle of a line costs that line.
TEST_F(OutboxTest, ATornLineTakesNoOtherWithIt) {
  std::ofstream{path_ / "told"} << "20261122T1000";
  fleet::Outbox outbox{path_, 10};
  outbox.add(numbered(1));
  const fs::path other = record_called(numbered(2).record);
  EXPECT_THAT(outbox.untold({record_called(numbered(1).record), other}, kNow), testing::ElementsAre(other));
}

using Backlog = Folder;

TEST_F(Backlog, TakesNoIdThatCouldNameAnotherFile) {
  const auto id = [](const std::string& printed) -> std::string {
    const auto result = fleet::parse_result("20261121T100000Z-0001", "t", printed);
    return result ? result->id : "none";
  };
  EXPECT_EQ(id(R"({"entry_identifier_uuid": "0f8fad5b-d9cb-469f-a165-70867728950e"})"),
            "0f8fad5b-d9cb-469f-a165-70867728950e");
  EXPECT_EQ(id(R"({"entry_identifier_uuid": "../../../etc/passwd"})"), "none");
  EXPECT_EQ(id(R"({"entry_identifier_uuid": ""})"), "none");
  EXPECT_EQ(id(R"({"entry_identifier_uuid": 7})"), "none");
  EXPECT_EQ(id("{}"), "none");
  EXPECT_EQ(id("Segmentation fault"), "none");
}

TEST_F(Backlog, HoldsTheRecordsOfTheDaemon) {
  const auto touch = [this](const std::string& name) {
    fs::create_directories((path_ / name).parent_path());
    std::ofstream{path_ / name} << "";
  };
  for (const char* name :
       {"20261121T100000Z-0001.h5", "2026/11/20261122T100000Z-0001.h5",
        "2026-11-23/20261123T100000Z-0001-2.h5", "pull.h5", "20261124T100000Z-0001.journal",
        "20261124T100000Z-0001.h5.part", "a/b/c/20261125T100000Z-0001.h5"})
    touch(name);
  std::vector<std::string> names;
  for (const fs::path& path : own_records(path_)) names.push_back(path.stem());
  EXPECT_THAT(names, testing::ElementsAre("20261121T100000Z-0001", "20261122T100000Z-0001",
                                          "20261123T100000Z-0001-2"));
  EXPECT_TRUE(own_records(path_ / "nowhere").empty());
}

}  // namespace
}  // namespace stickslip::io
