// Every code of a finding through every output.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "io/findings_text.hpp"
#include "io/results_json.hpp"
#include "report/report_json.hpp"
#include "report/report_page.hpp"
#include "report/report_text.hpp"
#include "report/truth_table.hpp"
#include <nlohmann/json.hpp>

#include "core/base/clock.hpp"
#include "core/base/finding.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/finding_json.hpp"
#include "core/record/json_codec.hpp"
#include "core/record/reader.hpp"
#include "daemon/app/log.hpp"
#include "daemon/control/metrics.hpp"
#include "daemon/fleet/messages.hpp"
#include "daemon/live/feed.hpp"
#include "daemon/types/test_log.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

using base::Finding;
using base::FindingKind;
using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

/// One of each code, with a sentence and a number of its own.
std::vector<Finding> one_of_each() {
  std::vector<Finding> findings;
  for (const FindingKind& kind : base::finding_kinds()) {
    base::add(findings, base::make_finding(kind.code, fmt::format("sentence of {}", kind.name),
                                           {{"measured", 0.25 + static_cast<double>(kind.code), "1"}}));
  }
  return findings;
}

analysis::TestResults results() {
  analysis::TestResults results = test::sample_results();
  results.findings = one_of_each();
  return results;
}

record::Record a_record() {
  record::Record record = test::whole_record();
  record.end->results = results();
  return record;
}

std::string row(const FindingKind& kind) {
  return fmt::format("| `{}` | {} | {} | {} | {} |", kind.name, base::name(kind.severity), kind.source,
                     kind.meaning, kind.action);
}

TEST(Findings, AreInTheDocumentAsInTheTable) {
  std::ifstream in{STICKSLIP_SOURCE_DIR "/docs/findings.md"};
  std::vector<std::string> found;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("| `")) found.push_back(line);
  }
  std::vector<std::string> expected;
  for (const FindingKind& kind : base::finding_kinds()) expected.push_back(row(kind));
  EXPECT_EQ(found, expected);
}

TEST(Findings, HaveACodeOfTheirOwnAndSentencesWithoutAFullStop) {
  std::vector<std::string_view> names;
  for (const FindingKind& kind : base::finding_kinds()) {
    EXPECT_TRUE(std::regex_match(std::string{kind.name}, std::regex{"[a-z]+(-[a-z]+)*"})) << kind.name;
    for (const std::string_view text : {kind.source, kind.meaning, kind.action}) {
      EXPECT_FALSE(text.empty()) << kind.name;
      EXPECT_FALSE(text.ends_with('.')) << kind.name;
    }
    names.push_back(kind.name);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST(Findings, StandTheMostSevereFirstAndElseAsTheyCame) {
  using enum base::FindingCode;
  std::vector<Finding> list;
  for (const auto& [code, text] :
       {std::pair{kLevelDrift, "a"}, {kZeroOffset, "b"}, {kSledMass, "c"}, {kPullSpeed, "d"}})
    base::add(list, base::make_finding(code, text));
  EXPECT_THAT(base::texts_of(list), ElementsAre("c", "b", "d", "a"));
}

// JSON has no such number, and a program would stumble.
TEST(Findings, HaveNoNumberThatIsNone) {
  EXPECT_TRUE(
      base::make_finding(base::FindingCode::kMisfit, "x", {{"residual", std::nan(""), "1"}}).numbers.empty());
}

TEST(Findings, OfManyTestsAreToldOnceForEachCode) {
  const std::vector<Finding> slow{base::make_finding(base::FindingCode::kPullSpeed, "slow")};
  const std::vector<Finding> both{base::make_finding(base::FindingCode::kPullSpeed, "slow"),
                                  base::make_finding(base::FindingCode::kLevelDrift, "drifts")};
  std::vector<io::TestFindings> tests{{1, both}};
  for (std::int64_t number = 2; number <= 9; ++number) tests.push_back({number, slow});
  tests[6].findings = {};
  EXPECT_EQ(io::findings_text(tests),
            "!  test 1: slow\n"
            "!  test 2: slow\n"
            "!  test 3: slow\n"
            "   alike in 5 more: test 4–6, 8, 9\n"
            "   → pull-speed, warning: correct the tester's speed, or pull_speed of the plan\n"
            "!  test 1: drifts\n"
            "   → level-drift, note: look at the cycles: S and K are means over this stretch\n");
}

// Older programs read the sentences from where they always were; a newer version's code stays what it is.
TEST(Findings, InJsonAreSentencesAndBesideThemWholeFindings) {
  Json json;
  Finding newer = one_of_each().front();
  newer.code = "of-a-newer-version";
  record::put_findings(std::vector{newer}, json);
  EXPECT_EQ(json["findings"], Json::array({newer.text}));
  EXPECT_THAT(record::findings_in(json), ElementsAre(newer));
  json.erase("coded_findings");
  EXPECT_THAT(record::findings_in(json),
              ElementsAre(base::make_finding(base::FindingCode::kUncoded, newer.text)));
}

class EveryOutput : public testing::Test {
 protected:
  /// In text: sentence, code, severity and action of each.
  static void expect_all_in(const std::string& text, std::string_view what) {
    for (const Finding& finding : one_of_each()) {
      EXPECT_THAT(text, HasSubstr(finding.text)) << what;
      EXPECT_THAT(text, HasSubstr(io::action_text(finding))) << what;
    }
  }
  /// In JSON: sentences, and the whole findings.
  static void expect_all_of(const Json& results, std::string_view what) {
    EXPECT_EQ(results.at("findings"), Json(base::texts_of(one_of_each()))) << what;
    EXPECT_EQ(record::findings_in(results), one_of_each()) << what;
  }

  /// The record as a file, where each test needs it.
  std::string published() {
    const std::string file = (folder_ / "a.h5").string();
    const auto done = record::publish_record(a_record(), file);
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
    return file;
  }

  test::TemporaryFolder folder_;
};

TEST_F(EveryOutput, RecordAndJournal) {
  const auto read = record::read_record(published());
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->end->results.findings, one_of_each());
  std::vector<std::byte> bytes;
  record::append_end_bytes(*a_record().end, bytes);
  EXPECT_EQ(record::end_from_bytes(bytes).results.findings, one_of_each());
}

// `stickslip analyze`, `list`, `show`, `watch` and `status` write these texts from the JSON of the daemon.
TEST_F(EveryOutput, TextAndJsonOfTheCommandLine) {
  report::TableRow row;
  row.results = results();
  expect_all_in(report::format_table({&row, 1}), "analyze");
  const std::vector<Finding> told = record::findings_in(io::results_json(results(), false));
  const io::TestFindings of_test{1, told};
  expect_all_in(io::findings_text({&of_test, 1}), "list");
  std::string text;
  for (const Finding& finding : told) text += io::finding_text(finding);
  expect_all_in(text, "show");
  expect_all_of(io::results_json(results(), true), "analyze --json");
  EXPECT_EQ(io::results_from_json(io::results_json(results(), true)).findings, one_of_each());
}

TEST_F(EveryOutput, Report) {
  auto material = report::read_material("", std::vector{published()}, report::Detail::kTraces, {});
  ASSERT_TRUE(material) << material.error().message;
  expect_all_in(report::report_text(*material), "text");
  expect_all_of(report::report_json(*material).at("tests").at(0), "JSON");
  const std::string csv = report::report_csv(*material);
  for (const Finding& finding : one_of_each())
    EXPECT_THAT(csv, HasSubstr(finding.code + ": " + finding.text));
  const std::string page = report::report_page(*material, {});
  for (const Finding& finding : one_of_each()) EXPECT_THAT(page, HasSubstr("\"" + finding.text + "\""));
}

TEST_F(EveryOutput, StatusMetricsPageAndBroker) {
  daemon::TestLog log;
  daemon::TestSummary summary;
  summary.results = results();
  log.add(summary);
  log.add({});
  daemon::Status status;
  status.findings = one_of_each();
  status.latest_test = summary;
  status.finding_counts = log.finding_counts();
  const Json json = daemon::status_json(status);
  expect_all_of(json, "status");
  expect_all_of(json.at("latest_test").at("results"), "latest test");
  const std::string metrics = control::metrics_text(status);
  for (const FindingKind& kind : base::finding_kinds()) {
    EXPECT_EQ(json.at("finding_counts").at(std::string{kind.name}), 1) << kind.name;
    EXPECT_THAT(metrics, HasSubstr(fmt::format("stickslip_findings_total{{code=\"{}\",severity=\"{}\"}} 1\n",
                                               kind.name, base::name(kind.severity))));
  }

  const test::ManualClock clock;
  std::vector<std::string> frames;
  live::LiveFeed feed{clock, [&](std::string frame) { frames.push_back(std::move(frame)); }};
  feed.listeners(1);
  pipeline::TestEnd end;
  end.results = results();
  feed.test_ended(end);
  ASSERT_EQ(frames.size(), 1U);
  expect_all_of(Json::parse(frames[0]).at("results"), "frame of the page and of watch");

  const record::Record record = a_record();
  expect_all_of(fleet::result_json(record.header, *record.end, record.end->cycles, "a.h5").at("results"),
                "broker");
}

TEST_F(EveryOutput, Log) {
  class Lines final : public app::LogOutput {
   public:
    explicit Lines(std::string& text) : text_(text) {}
    void write(const app::LogEntry& entry) override { text_ += entry.message + "\n"; }

   private:
    std::string& text_;
  };
  std::string text;
  const auto log = app::make_log(io::LogLevel::kInfo, std::make_unique<Lines>(text));
  pipeline::TestEnd end;
  end.results = results();
  log->test_ended(end);
  expect_all_in(text, "log");
}

}  // namespace
}  // namespace stickslip
