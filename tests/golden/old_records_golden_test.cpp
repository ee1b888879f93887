// Records of every format version, as the program of that time wrote them (records/VERSION/), are read in
// full by this one: each number and text is compared with what h5py found in the file when it was frozen.
// These files are never made anew. A new version gets a folder of its own:
//
//     tests/golden/list_record.py FILE.h5 > FILE.json

#include <gmock/gmock.h>
#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>

#include "core/record/enum_names.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/journal_format.hpp"
#include "core/record/reader.hpp"
#include "tests/golden/record_listing.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

namespace fs = std::filesystem;
using record::FieldName;
using test::ListedFields;
using test::RecordListing;

const fs::path kRecords{STICKSLIP_SOURCE_DIR "/tests/golden/records"};

template <typename Row, typename Value>
std::vector<Value> column_of(const auto& rows, Value Row::*member) {
  std::vector<Value> column;
  column.reserve(rows.size());
  for (const Row& row : rows) column.push_back(row.*member);
  return column;
}

void compare_identity(RecordListing& listing, const record::Record& record) {
  const ListedFields fields{listing, "entry"};
  fields(FieldName{"title", "", ""}, record.header.title);
  fields(FieldName{"entry_identifier_uuid", "", ""}, record.header.uuid);
  fields(FieldName{"test_number", "1", ""}, record.header.test_number);
  fields(FieldName{"trigger_scan", "1", ""}, record.header.trigger_scan);
  const auto time = [&](const char* name, std::optional<std::int64_t> time_ns) {
    fields(FieldName{name, "", ""}, time_ns ? record::iso_time(*time_ns) : std::string{});
  };
  time("start_time", record.header.start_realtime_ns);
  time("end_time", record.end->end_realtime_ns);
  const double extent = static_cast<double>(record.scan.back() - record.scan.front() + 1);
  for (const auto& [key, text] : record.header.sample.metadata)
    listing.expect_text("entry/metadata/" + key, text);
  listing.expect_number("entry/collection_time", "s", extent / record.header.board.scan_rate_granted_Hz);
}

void compare_raw(RecordListing& listing, const record::Record& record) {
  const daq::BoardInfo& board = record.header.board;
  listing.expect_column("entry/raw/scan", "1", record.scan);
  std::vector<double> time_s;
  std::vector<std::uint8_t> flags;
  std::vector<float> force_N;
  std::vector<std::uint16_t> counts;
  const daq::Calibration calibration{board, record.header.load_cell.value_or(daq::LoadCell{}), 1.0};
  for (std::size_t i = 0; i < record.scan.size(); ++i) {
    time_s.push_back(static_cast<double>(record.scan[i] - record.scan.front()) / board.scan_rate_granted_Hz);
    const bool spike = std::binary_search(record.spikes.begin(), record.spikes.end(), record.scan[i]);
    flags.push_back(
        static_cast<std::uint8_t>((spike ? 5U : 0U) | (calibration.saturated(record.raw[i]) ? 2U : 0U)));
    counts.push_back(static_cast<std::uint16_t>(record.raw[i]));
    force_N.push_back(static_cast<float>(calibration.force_N(record.raw[i])));
  }
  listing.expect_column("entry/raw/time", "s", time_s);
  listing.expect_column("entry/raw/flags", "1", flags);
  if (board.quantity == daq::RawQuantity::kCounts) {
    listing.expect_column("entry/raw/counts", "1", counts);
    listing.expect_attribute("entry/raw/counts", "maxdata", board.maxdata);
    listing.expect_column("entry/raw/force", "N", force_N);
  } else {
    const record::QuantityName quantity = record::name(board.quantity);
    listing.expect_column("entry/raw/" + std::string{quantity.name}, quantity.unit, record.raw);
  }
}

void compare_second(RecordListing& listing, const record::Record& record) {
  if (!record.header.board.second) return;
  const daq::SecondChannel& channel = *record.header.board.second;
  const std::string name{daq::name(channel.quantity)};
  listing.expect_text("entry/instrument/second/quantity", name);
  record::for_each_field(channel, ListedFields{listing, "entry/instrument/second"});
  if (record.second.empty()) return;
  std::vector<float> values;
  for (const std::int32_t code : record.second) values.push_back(static_cast<float>(channel.value(code)));
  listing.expect_column("entry/raw/" + name,
                        channel.quantity == daq::SecondQuantity::kPullSpeed ? "m/s" : "m", values);
  listing.expect_column("entry/raw/" + name + "_counts", "1", record.second);
}

void compare_latency(RecordListing& listing, const record::EndRecord& end) {
  if (!end.read_latency) return;
  const std::string group = "entry/timing/read_latency/";
  std::vector<double> limits_s;
  for (std::size_t bin = 0; bin < daq::LatencyHistogram::kBins; ++bin)
    limits_s.push_back(daq::LatencyHistogram::limit_s(bin));
  const auto& counts = end.read_latency->counts();
  listing.expect_column(group + "below", "s", limits_s);
  listing.expect_column(group + "read_count", "1", std::vector<std::uint64_t>(counts.begin(), counts.end()));
  listing.expect_number(group + "largest", "s", end.read_latency->largest_s());
}

void compare_tables(RecordListing& listing, const record::Record& record) {
  record::for_each_cycle_column([&](const FieldName& name, auto member) {
    if (!listing.has("entry/cycles/" + std::string{name.name})) {  // Came later.
      for (const detect::Cycle& cycle : record.cycles)
        EXPECT_TRUE(std::isnan(static_cast<double>(cycle.*member)));
      return;
    }
    listing.expect_column("entry/cycles/" + std::string{name.name}, name.unit,
                          column_of<detect::Cycle>(record.cycles, member));
  });
  listing.expect_column("entry/gaps/first_scan", "1", column_of<daq::Gap>(record.gaps, &daq::Gap::first));
  listing.expect_column("entry/gaps/scan_count", "1", column_of<daq::Gap>(record.gaps, &daq::Gap::count));
  std::vector<std::uint8_t> estimated;
  std::vector<std::string> causes;
  for (const daq::Gap& gap : record.gaps) {
    estimated.push_back(gap.estimated ? 1 : 0);
    causes.emplace_back(daq::name(gap.cause));
  }
  listing.expect_column("entry/gaps/estimated", "1", estimated);
  listing.expect_texts("entry/gaps/cause", causes);
  using record::Event;
  listing.expect_column("entry/events/scan", "1", column_of<Event>(record.events, &Event::scan));
  listing.expect_column("entry/events/realtime", "ns", column_of<Event>(record.events, &Event::realtime_ns));
  listing.expect_texts("entry/events/text", column_of<Event>(record.events, &Event::text));
  using daq::ClockAnchor;
  listing.expect_column("entry/timing/scan", "1", column_of<ClockAnchor>(record.anchors, &ClockAnchor::scan));
  listing.expect_column("entry/timing/monotonic_raw", "ns",
                        column_of<ClockAnchor>(record.anchors, &ClockAnchor::monotonic_ns));
  listing.expect_column("entry/timing/realtime", "ns",
                        column_of<ClockAnchor>(record.anchors, &ClockAnchor::realtime_ns));
}

void compare_instrument(RecordListing& listing, const record::Record& record) {
  const record::RecordHeader& header = record.header;
  record::for_each_field(header.tester, ListedFields{listing, "entry/instrument/tester"});
  record::for_each_name_field(header.board, ListedFields{listing, "entry/instrument/adc"});
  if (header.board.quantity == daq::RawQuantity::kCounts) {
    record::for_each_converter_field(header.board, ListedFields{listing, "entry/instrument/adc"});
  }
  const ListedFields calibration{listing, "entry/instrument/calibration"};
  record::for_each_field(header.calibration, calibration);
  if (header.load_cell) record::for_each_field(*header.load_cell, calibration);
  record::for_each_rate_field(header.board, ListedFields{listing, "entry/timing"});
  record::for_each_field(header.sample, ListedFields{listing, "entry/sample"});
  listing.expect_text("entry/user/name", header.sample.operator_name);
  record::for_each_field(header.plan, ListedFields{listing, "entry/plan"});
  if (!header.self_check) return;
  record::for_each_field(*header.self_check, ListedFields{listing, "entry/self_check"});
  const std::vector<std::uint16_t> idle(header.self_check->raw.begin(), header.self_check->raw.end());
  if (!idle.empty()) listing.expect_column("entry/self_check/counts", "1", idle);
}

void compare_process(RecordListing& listing, const record::Record& record) {
  record::for_each_field(record.header.process, ListedFields{listing, "entry/process"});
  const record::EndRecord& end = *record.end;
  listing.expect_text("entry/process/status", std::string{record::name(end.status)});
  listing.expect_texts("entry/process/reasons", end.reasons);
  listing.expect_text("entry/process/end_cause", end.cause);
  ListedFields{listing, "entry/process"}(FieldName{"compute_time", "s", ""}, end.compute_time_s);
  ListedFields{listing, "entry/process"}(FieldName{"unloaded_level", "1", ""}, end.unloaded_level);
  listing.expect_text("entry/process/sha256", record.sha256);
  // The seal belongs to the file as it lies there, and is checked with it.
  if (!listing.has("entry/process/file_sha256")) return;
  listing.expect_number("entry/process/scan_count", "1", static_cast<std::int64_t>(record.scan.size()));
  listing.look_at("entry/process/file_sha256");
}

void compare_results(RecordListing& listing, const analysis::TestResults& results) {
  const std::string group = "entry/results/";
  listing.expect_text(group + "regime", std::string{model::name(results.regime)});
  listing.expect_attribute(group + "regime", "reason", results.regime_reason);
  listing.expect_texts(group + "findings", base::texts_of(results.findings));
  if (results.rung_reason == record::kNoSuchResultThen) {
    listing.expect_absent(group + "rung");
  } else {
    listing.expect_text(group + "rung", std::string{analysis::name(results.rung)});
    listing.expect_attribute(group + "rung", "reason", results.rung_reason);
    listing.expect_attribute(
        group + "misfit", "place",
        results.misfit_place.empty() ? nlohmann::json{} : nlohmann::json(results.misfit_place));
  }
  const bool has_diagnostics = listing.version() >= 3;
  const auto known = [](std::optional<double> number) {
    return number ? nlohmann::json{*number}[0] : nlohmann::json{};
  };
  analysis::for_each_result(
      results, [&](const analysis::ResultName& name, const analysis::Estimate& estimate) {
        const std::string path = fmt::format(
            "{}{}{}", group, name.is_diagnostic && has_diagnostics ? "diagnostics/" : "", name.name);
        if (estimate.reason == record::kNoSuchResultThen) return listing.expect_absent(path);
        listing.expect_number(path, name.unit, estimate.value.value_or(std::nan("")));
        listing.expect_attribute(path, "standard_error", known(estimate.standard_error));
        listing.expect_attribute(path, "systematic_uncertainty", known(estimate.systematic_uncertainty));
        listing.expect_attribute(path, "reason",
                                 estimate.value ? nlohmann::json{} : nlohmann::json(estimate.reason));
      });
}

void compare_truth(RecordListing& listing, const record::Record& record) {
  if (!record.end->truth) return;
  const model::TestTruth& truth = *record.end->truth;
  const std::string group = "entry/truth";
  record::for_each_field(truth, ListedFields{listing, group});
  listing.expect_text(group + "/regime", std::string{model::name(truth.regime)});
  if (truth.solver) record::for_each_field(*truth.solver, ListedFields{listing, group + "/solver"});
  if (!record.true_coefficient.empty()) {
    listing.expect_column(group + "/coefficient", "1", record.true_coefficient);
  }
  using model::ModeInterval;
  listing.expect_column(group + "/modes/start_time", "s",
                        column_of<ModeInterval>(truth.modes, &ModeInterval::start_s));
  listing.expect_column(group + "/modes/end_time", "s",
                        column_of<ModeInterval>(truth.modes, &ModeInterval::end_s));
  std::vector<std::string> modes;
  for (const ModeInterval& mode : truth.modes) modes.emplace_back(model::name(mode.mode));
  listing.expect_texts(group + "/modes/mode", modes);
  record::for_each_true_cycle_column([&](const FieldName& name, auto member) {
    listing.expect_column(group + "/cycles/" + std::string{name.name}, name.unit,
                          column_of<model::TrueCycle>(truth.cycles, member));
  });
}

class OldRecords : public testing::TestWithParam<const char*> {};

TEST_P(OldRecords, AreReadInFull) {
  const fs::path file = kRecords / GetParam();
  const auto read = record::read_record(file);
  ASSERT_TRUE(read) << read.error().message;
  RecordListing listing{fs::path{file}.replace_extension(".json")};
  EXPECT_EQ(std::to_string(listing.version()), file.parent_path().filename());
  ASSERT_FALSE(read->scan.empty());

  compare_identity(listing, *read);
  compare_raw(listing, *read);
  compare_second(listing, *read);
  compare_latency(listing, *read->end);
  compare_tables(listing, *read);
  compare_instrument(listing, *read);
  compare_process(listing, *read);
  compare_results(listing, read->end->results);
  compare_truth(listing, *read);
  EXPECT_THAT(listing.not_looked_at(), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Version3, OldRecords, testing::Values("3/every-field.h5"));
INSTANTIATE_TEST_SUITE_P(Version2, OldRecords, testing::Values("2/daemon.h5", "2/every-field.h5"));
INSTANTIATE_TEST_SUITE_P(Version1, OldRecords,
                         testing::Values("1/daemon.h5", "1/simulated.h5", "1/imported.h5",
                                         "1/every-field.h5"));

// A program that was killed leaves a journal, and the next start may be that of a newer program.
TEST(OldJournal, BecomesTheRecordThatItWouldHaveBecomeThen) {
  for (const char* version : {"1", "2", "3"}) {
    SCOPED_TRACE(version);
    const test::TemporaryFolder folder;
    fs::copy_file(kRecords / version / "every-field.journal", folder / "a.journal");
    fs::permissions(folder / "a.journal", fs::perms::owner_write, fs::perm_options::add);
    const auto file = record::finalise(folder / "a.journal");
    ASSERT_TRUE(file) << file.error().message;
    const auto now = record::read_record(file->file);
    const auto then = record::read_record(kRecords / version / "every-field.h5");
    ASSERT_TRUE(now) << now.error().message;
    ASSERT_TRUE(then);
    test::expect_same_record(*now, *then);
  }
}

/// A copy of a golden record in which `change` altered something through the bare library.
fs::path altered(const test::TemporaryFolder& folder, const std::function<void(hid_t)>& change) {
  fs::path path = folder / "altered.h5";
  fs::copy_file(kRecords / "1/every-field.h5", path);
  fs::permissions(path, fs::perms::owner_write, fs::perm_options::add);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  EXPECT_GE(file, 0);
  change(file);
  EXPECT_GE(H5Fclose(file), 0);
  return path;
}

TEST(OldRecord, MadeBeforeSomeColumnsAndResultsIsReadWithoutThem) {
  const test::TemporaryFolder folder;
  const std::vector<const char*> later{"entry/cycles/pull_speed",
                                       "entry/results/pull_speed_measured",
                                       "entry/results/escape_speed",
                                       "entry/results/mu_k_from_mean",
                                       "entry/results/delta_mu_combined",
                                       "entry/truth/coefficient",
                                       "entry/truth/solver",
                                       "entry/results/findings"};
  const fs::path path = altered(folder, [&](hid_t file) {
    for (const char* name : later) EXPECT_GE(H5Ldelete(file, name, H5P_DEFAULT), 0) << name;
  });
  const auto read = record::read_record(path);
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->cycles.size(), 2U);
  for (const detect::Cycle& cycle : read->cycles) EXPECT_TRUE(std::isnan(cycle.pull_speed_m_per_s));
  EXPECT_FALSE(read->end->results.escape_speed.value);
  EXPECT_EQ(read->end->results.escape_speed.reason, record::kNoSuchResultThen);
  EXPECT_EQ(read->end->results.delta_mu_combined.reason, record::kNoSuchResultThen);
  EXPECT_TRUE(read->end->results.delta_mu.value);
  EXPECT_TRUE(read->end->results.findings.empty());
  EXPECT_TRUE(read->true_coefficient.empty());
  EXPECT_FALSE(read->end->truth->solver);
}

TEST(NewerRecord, IsRefusedByItsVersion) {
  for (const std::int64_t version : {std::int64_t{9}, std::int64_t{0}, record::kFormatVersion + 1}) {
    const test::TemporaryFolder folder;
    const fs::path path = altered(folder, [&](hid_t file) {
      const hid_t attribute = H5Aopen(file, "format_version", H5P_DEFAULT);
      EXPECT_GE(H5Awrite(attribute, H5T_NATIVE_INT64, &version), 0);
      H5Aclose(attribute);
    });
    const auto read = record::read_record(path);
    ASSERT_FALSE(read);
    EXPECT_EQ(read.error().exit_status(), 2);
    EXPECT_THAT(read.error().message, testing::HasSubstr(fmt::format(
                                          "is stickslip-record version {}; this program reads {} to {}",
                                          version, record::kOldestFormatVersion, record::kFormatVersion)));
  }
}

TEST(NewerJournal, IsRefusedByItsVersion) {
  const test::TemporaryFolder folder;
  std::string bytes = test::content_of(kRecords / "1/every-field.journal");
  const std::string version = "\"format_version\":1";
  ASSERT_NE(bytes.find(version), std::string::npos);
  bytes.replace(bytes.find(version), version.size(), "\"format_version\":9");
  record::EntryHead head;
  std::memcpy(&head, bytes.data(), sizeof head);
  head.crc = record::entry_crc(
      head, std::as_bytes(std::span{bytes}.subspan(record::kEntryHeadSize, head.payload_size)));
  std::memcpy(bytes.data(), &head, sizeof head);
  test::write_content(folder / "a.journal", bytes);

  const auto file = record::finalise(folder / "a.journal");

  ASSERT_FALSE(file);
  EXPECT_THAT(file.error().message,
              testing::HasSubstr("is stickslip-record version 9; this program reads 1 to"));
  EXPECT_TRUE(fs::exists(folder / "a.journal"));  // For that newer program.
}

}  // namespace
}  // namespace stickslip
