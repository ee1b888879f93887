#include "daemon/control/metrics.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace stickslip::daemon {
namespace {

/// A page of the exposition format, taken apart by its rules: HELP, TYPE and then the samples of one family
/// at a time, each family once.
struct Exposition {
  struct Sample {
    std::string name;
    std::string labels;
    double value;
  };
  std::map<std::string, std::string> types;
  std::map<std::string, std::vector<Sample>> families;
  std::vector<std::string> breaches;

  explicit Exposition(const std::string& text) {
    std::istringstream in{text};
    const std::regex help{R"(# HELP ([a-z_:][a-z0-9_:]*) \S.*)"};
    const std::regex type{R"(# TYPE ([a-z_:][a-z0-9_:]*) (counter|gauge|histogram))"};
    // Of a label backslash, quote and line feed are escaped, and nothing else.
    const std::string label = R"re([a-z_]+="(?:[^"\\]|\\[\\"n])*")re";
    const std::regex sample{"([a-z_:][a-z0-9_:]*)(\\{" + label + "(?:," + label + ")*\\})? (\\S+)"};
    std::string family;
    std::string helped;
    if (!text.ends_with('\n')) breaches.emplace_back("the last line has no end");
    for (std::string line; std::getline(in, line);) {
      std::smatch match;
      if (std::regex_match(line, match, help)) {
        helped = match[1];
      } else if (std::regex_match(line, match, type)) {
        family = match[1];
        if (helped != family) breaches.push_back(family + ": no HELP before TYPE");
        if (!types.emplace(family, match[2]).second) breaches.push_back(family + ": twice");
      } else if (std::regex_match(line, match, sample)) {
        const std::string name = match[1];
        const bool histogram = types[family] == "histogram";
        const bool own =
            histogram ? name == family + "_bucket" || name == family + "_sum" || name == family + "_count"
                      : name == family;
        if (!own) breaches.push_back(fmt::format("{}: not of the family {}", name, family));
        families[family].push_back({name, match[2], std::stod(match[3])});
      } else {
        breaches.push_back("no line of this format: " + line);
      }
    }
  }
};

Status busy() {
  Status status;
  status.state = "acquiring";
  status.version = "1.0 \"a\\b\"\nc";
  status.fleet.emplace().dropped_result_count = 3;
  status.latency.add(20e3);    // 20 µs
  status.latency.add(500e3);   // 0.5 ms
  status.latency.add(2500e6);  // 2.5 s, above all limits
  status.commit_time.add(3e6);
  status.ring = {.capacity = 12000, .high_water = 40};
  status.trend = trend_state(trend::TesterCharts{});
  return status;
}

TEST(Metrics, PageKeepsTheRulesOfTheFormat) {
  const std::string text = control::metrics_text(busy());
  const Exposition page{text};
  EXPECT_EQ(page.breaches, std::vector<std::string>{}) << text;
  EXPECT_GT(page.families.size(), 15U);
  for (const auto& [family, type] : page.types) {
    EXPECT_FALSE(page.families.at(family).empty()) << family;
    EXPECT_EQ(family.ends_with("_total"), type == "counter") << family;
  }
}

// docs/control.md has a row for each, and for nothing else.
TEST(Metrics, EachIsDocumented) {
  Status status = busy();
  status.board.emplace();
  status.scan_rate_measured.emplace();
  status.storage.room_h = 3.0;
  std::set<std::string> served;
  for (const auto& [family, type] : Exposition{control::metrics_text(status)}.types) served.insert(family);
  std::set<std::string> documented;
  std::ifstream in{STICKSLIP_SOURCE_DIR "/docs/control.md"};
  const std::regex name{"`(stickslip_[a-z_]+)"};
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("| `stickslip_")) continue;
    const std::string names = line.substr(0, line.find(" | "));
    for (std::sregex_iterator it{names.begin(), names.end(), name}, end; it != end; ++it)
      documented.insert((*it)[1]);
  }
  EXPECT_EQ(documented, served);
}

// Buckets are cumulative, the last is +Inf and equals the count; the sum is that of what was added.
TEST(Metrics, HistogramsAreWhole) {
  const Exposition page{control::metrics_text(busy())};
  std::set<std::string> found;
  for (const auto& [family, type] : page.types) {
    if (type != "histogram") continue;
    found.insert(family);
    double before = 0.0;
    double limit_before = 0.0;
    std::string last;
    std::map<std::string, double> totals;
    for (const Exposition::Sample& sample : page.families.at(family)) {
      if (sample.name != family + "_bucket") {
        totals[sample.name.substr(family.size())] = sample.value;
        continue;
      }
      EXPECT_GE(sample.value, before) << family << sample.labels;
      before = sample.value;
      last = sample.labels;
      const std::string limit = sample.labels.substr(5, sample.labels.size() - 7);
      if (limit == "+Inf") continue;
      EXPECT_GT(std::stod(limit), limit_before) << family;
      limit_before = std::stod(limit);
    }
    EXPECT_EQ(last, "{le=\"+Inf\"}") << family;
    ASSERT_EQ(totals.size(), 2U) << family;
    EXPECT_EQ(totals.at("_count"), before) << family;
  }
  EXPECT_EQ(found, (std::set<std::string>{"stickslip_read_latency_seconds", "stickslip_commit_seconds"}));
  for (const Exposition::Sample& sample : page.families.at("stickslip_read_latency_seconds")) {
    // Three additions of numbers with 53 bits each.
    if (sample.name.ends_with("_sum")) {
      EXPECT_NEAR(sample.value, 2.50052, 1e-15 * 3 * 2.50052);
    } else if (sample.name.ends_with("_count")) {
      EXPECT_EQ(sample.value, 3.0);
    }
  }
}

// Prometheus takes a counter that falls for a new start; one in 142 days of scans would be one too many, and
// so would one that stands still for want of digits.
TEST(Metrics, CountersBeyond32BitsAreWholeToTheLastDigit) {
  constexpr std::uint64_t kBeyond = (std::uint64_t{1} << 32) + 1;
  Status status = busy();
  status.scan_count = kBeyond;
  status.gap_count = kBeyond + 1;
  status.lost_scan_count = static_cast<std::int64_t>(kBeyond + 2);
  status.dropped_scan_count = kBeyond + 3;
  status.latency = {daq::LatencyHistogram::Counts{kBeyond, 1}, 1e-3};
  const std::string text = control::metrics_text(status);
  for (const char* line :
       {"stickslip_scans_total 4294967297", "stickslip_gaps_total 4294967298",
        "stickslip_lost_scans_total 4294967299", "stickslip_dropped_scans_total 4294967300",
        "stickslip_read_latency_seconds_count 4294967298"}) {
    EXPECT_NE(text.find(fmt::format("\n{}\n", line)), std::string::npos) << line << '\n' << text;
  }
}

}  // namespace
}  // namespace stickslip::daemon
