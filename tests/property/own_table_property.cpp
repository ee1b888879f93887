// What `stickslip export --csv` writes of any record, `stickslip import` makes the same record of again.

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "io/export_csv.hpp"
#include "io/traces/import.hpp"

#include "tests/support/hostile_text.hpp"
#include "tests/support/imported_record.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::traces {
namespace {

using daq::RawQuantity;

/// A finite number of any size.
double any_finite() {
  return *rc::gen::suchThat<double>([](double value) { return std::isfinite(value); });
}

/// Text as it comes out of a journal: UTF-8.
std::string any_text() {
  const std::string text = *test::hostile();
  return base::is_utf8(text) ? text : "plain";
}

record::RecordHeader any_header() {
  record::RecordHeader header = test::sample_header();
  header.self_check->raw.clear();
  header.board.quantity = *rc::gen::element(RawQuantity::kCounts, RawQuantity::kVolts, RawQuantity::kForce_N,
                                            RawQuantity::kCoefficient);
  if (header.board.quantity != RawQuantity::kCounts) header.board.second.reset();
  if (header.board.second && *rc::gen::arbitrary<bool>())
    header.board.second->quantity = daq::SecondQuantity::kSledPosition;
  if (*rc::gen::arbitrary<bool>()) header.board.second.reset();
  if (*rc::gen::arbitrary<bool>()) header.start_realtime_ns.reset();
  if (*rc::gen::arbitrary<bool>()) header.tester.sled_mass_kg.reset();
  if (header.board.quantity != RawQuantity::kCounts && *rc::gen::arbitrary<bool>()) header.load_cell.reset();
  header.board.scan_rate_granted_Hz = *rc::gen::element(350.0000350000035, 1.0 / 3.0, 20'000.0);
  header.title = any_text();
  header.sample.name = any_text();
  header.sample.operator_name = any_text();
  header.process.configuration = any_text();
  header.calibration.refused = {any_text(), "=1+1", "-2"};
  return header;
}

record::Record any_record() {
  record::Record record;
  record.header = any_header();
  const daq::BoardInfo& board = record.header.board;
  record::EndRecord end = test::sample_end();
  end.truth.reset();
  end.cycles = {};
  end.results = {};
  end.compute_time_s.reset();
  end.spikes.clear();
  end.reasons = {any_text()};
  auto scan = *rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << 40);
  for (auto count = *rc::gen::inRange(0, 60); count > 0; --count) {
    if (!record.scan.empty() && *rc::gen::inRange(0, 8) == 0) {
      const auto lost = *rc::gen::inRange<std::int64_t>(1, 1'000'000);
      record.gaps.push_back(
          {scan, lost, *rc::gen::arbitrary<bool>(),
           *rc::gen::element(daq::GapCause::kOverrun, daq::GapCause::kUnknown, daq::GapCause::kDamaged)});
      scan += lost;
    }
    record.scan.push_back(scan);
    record.raw.push_back(board.quantity == RawQuantity::kCounts
                             ? static_cast<double>(*rc::gen::inRange<std::int64_t>(0, board.maxdata + 1))
                             : any_finite());
    if (board.second) record.second.push_back(*rc::gen::inRange<std::int32_t>(-1, 4096));
    if (*rc::gen::inRange(0, 5) == 0) end.spikes.push_back(scan);
    ++scan;
  }
  record.anchors = {{3, 5'000'000'000, 1'795'265'582'000'000'000}};
  record.events = {{7, 1'795'265'582'050'000'000, any_text()}};
  record::set_end(record, std::move(end));
  return record;
}

RC_GTEST_PROP(OwnTableProperty, AnExportedRecordComesBack, ()) {
  const record::Record record = any_record();
  RC_CLASSIFY(!record.gaps.empty(), "gaps");
  RC_CLASSIFY(!record.second.empty(), "second channel");
  RC_CLASSIFY(!record.spikes.empty(), "spikes");
  const test::TemporaryFolder folder;
  ImportRequest request;
  request.path = folder / "trace.csv";
  test::write_content(request.path, io::scans_csv(record));
  auto imported = import_trace(request);
  if (!imported) RC_FAIL(imported.error().message);
  RC_ASSERT(imported->is_own);
  RC_ASSERT(imported->tests.size() == 1U);
  record::Record back = test::in_memory(imported->tests.front());
  // Where it comes from is new.
  record::ProcessFacts& process = back.header.process;
  RC_ASSERT(process.source_file == "trace.csv");
  const record::ProcessFacts& before = record.header.process;
  process.source_file = before.source_file;
  process.source_size = before.source_size;
  process.source_sha256 = before.source_sha256;
  process.source_reading = before.source_reading;
  back.end->spikes = record.end->spikes;
  test::expect_same_record(record, back);
  RC_ASSERT(!testing::Test::HasFailure());
}

RC_GTEST_PROP(OwnTableProperty, ATableThatWasCutIsRefused, ()) {
  const std::string whole = io::scans_csv(any_record());
  const test::TemporaryFolder folder;
  ImportRequest request;
  request.path = folder / "trace.csv";
  const auto size = *rc::gen::inRange<std::size_t>(0, whole.size() - 1);
  test::write_content(request.path, whole.substr(0, size));
  const auto imported = import_trace(request);
  RC_ASSERT(!imported.has_value());
  RC_ASSERT(imported.error().exit_status() == 2);
  RC_ASSERT(imported.error().message.find('\n') == std::string::npos);
}

RC_GTEST_PROP(OwnTableProperty, ATableThatLacksARowIsRefused, ()) {
  const record::Record record = any_record();
  RC_PRE(!record.scan.empty());
  std::string text = io::scans_csv(record);
  std::size_t at = text.find("\ntime_s,scan") + 1;
  const auto row = *rc::gen::inRange<std::size_t>(0, record.scan.size());
  for (std::size_t i = 0; i <= row; ++i) at = text.find('\n', at) + 1;
  const std::string line = text.substr(at, text.find('\n', at) + 1 - at);
  text.erase(at, line.size());
  const test::TemporaryFolder folder;
  ImportRequest request;
  request.path = folder / "trace.csv";
  test::write_content(request.path, text);
  const auto imported = import_trace(request);
  RC_ASSERT(!imported.has_value());
  RC_ASSERT(imported.error().message.find("missing") != std::string::npos);
  // Nor does it stand below the end.
  test::write_content(request.path, text + line);
  RC_ASSERT(!import_trace(request).has_value());
  // Of older versions, which did not write the number of rows, gaps tell the rows between others.
  const std::size_t count = text.rfind("# scans: ");
  text.erase(count, text.find('\n', count) + 1 - count);
  test::write_content(request.path, text);
  RC_ASSERT(import_trace(request).has_value() ==
            (record.scan.size() > 1 && (row == 0 || row + 1 == record.scan.size())));
}

RC_GTEST_PROP(OwnTableProperty, ASecondHeaderIsRefusedWhereverItStands, ()) {
  std::string text = io::scans_csv(any_record());
  const std::size_t header = text.find("\n# header: {") + 1;
  const std::string line = text.substr(header, text.find('\n', header) + 1 - header);
  auto lines = *rc::gen::inRange<std::size_t>(0, static_cast<std::size_t>(std::ranges::count(text, '\n')));
  std::size_t at = 0;
  for (; lines > 0; --lines) at = text.find('\n', at) + 1;
  text.insert(at, line);
  const test::TemporaryFolder folder;
  ImportRequest request;
  request.path = folder / "trace.csv";
  test::write_content(request.path, text);
  const auto imported = import_trace(request);
  RC_ASSERT(!imported.has_value());
  RC_ASSERT(imported.error().message.find("it stands once, above the table") != std::string::npos);
}

RC_GTEST_PROP(OwnTableProperty, AGapThatOverlapsARowIsRefused, ()) {
  record::Record record = any_record();
  RC_PRE(!record.scan.empty());
  record.gaps.push_back({*rc::gen::elementOf(record.scan), 1, true, daq::GapCause::kUnknown});
  const test::TemporaryFolder folder;
  ImportRequest request;
  request.path = folder / "trace.csv";
  test::write_content(request.path, io::scans_csv(record));
  const auto imported = import_trace(request);
  RC_ASSERT(!imported.has_value());
  RC_ASSERT(imported.error().message.find("has a row of it") != std::string::npos);
}

}  // namespace
}  // namespace stickslip::traces
