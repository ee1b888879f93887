#include <gmock/gmock.h>

#include <cstdlib>

#include "core/record/csv_import.hpp"
#include "core/record/finaliser.hpp"
#include "core/record/reader.hpp"
#include "tests/support/record_equality.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

using record::CsvImportRequest;
using record::read_csv;
using test::TemporaryFolder;
using testing::HasSubstr;

class CsvImport : public testing::Test {
 protected:
  /// Imports column `F` of a file with this content at 1000 Hz.
  base::Result<record::Record> import(const std::string& content, double rate_Hz = 1000.0) {
    test::write_content(path(), content);
    request_.path = path();
    request_.column = "F";
    request_.rate_Hz = rate_Hz;
    return read_csv(request_);
  }

  void expect_refused(const std::string& content, const std::string& reason) {
    const auto record = import(content);
    ASSERT_FALSE(record) << content;
    EXPECT_EQ(record.error().exit_status(), 2);
    EXPECT_THAT(record.error().message, HasSubstr(reason));
    EXPECT_THAT(record.error().message, HasSubstr("trace.csv"));
    EXPECT_EQ(record.error().message.find('\n'), std::string::npos);
  }

  [[nodiscard]] std::filesystem::path path() const { return folder_ / "trace.csv"; }

  TemporaryFolder folder_;
  CsvImportRequest request_;
};

TEST_F(CsvImport, TakesTheValuesOfTheNamedColumn) {
  const auto record = import("t_s,F\n0.000,0.25\n0.001,-1e-3\n0.002,+3\n");
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(record->raw, (std::vector<double>{0.25, -0.001, 3.0}));
  EXPECT_EQ(record->scan, (std::vector<daq::ScanIndex>{0, 1, 2}));
  EXPECT_EQ(record->header.board.scan_rate_granted_Hz, 1000.0);
  EXPECT_EQ(record->header.title, "trace");
}

TEST_F(CsvImport, ReadsWhatSpreadsheetsWrite) {
  const auto record =
      import("\xEF\xBB\xBF\"F\",\"note, long\"\r\n0.5,\"a \"\"b\"\"\nsecond line\"\r\n1,\r\n");
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(record->raw, (std::vector<double>{0.5, 1.0}));
}

TEST_F(CsvImport, LastLineNeedsNoNewline) {
  const auto record = import("F\n1\n2");
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(record->raw, (std::vector<double>{1.0, 2.0}));
}

TEST_F(CsvImport, RefusesWhatIsNoTable) {
  expect_refused("", "is empty");
  expect_refused("F\n", "no rows after the header");
  expect_refused("a,b\n1,2\n", ":1: there is no column 'F'; there are: a, b");
  expect_refused("a,\"b\nc\"\n1,2\n", "there is no column 'F'; there are: a, b\\x0ac");
  expect_refused("F,F\n1,2\n", ":1: there are several columns 'F'");
  expect_refused("F,b\n1,2\n1\n", ":3: row has 1 fields, the header has 2");
  expect_refused("F,b\n1,2\n1,2,3\n", ":3: row has 3 fields, the header has 2");
  expect_refused("F\n1\n\n2\n", ":3: line is empty");
  expect_refused("F\n1\n\"2\n", "a quoted field does not end");
  expect_refused("F\n1\n2\"2\n", ":3: a quote stands where none may");
}

TEST_F(CsvImport, RefusesWhatIsNoFiniteNumber) {
  expect_refused("F\n1\nabc\n", ":3: column 'F' is 'abc': a number is needed");
  expect_refused("F\n1\n1.5N\n", ":3: column 'F' is '1.5N'");
  expect_refused("F,b\n,2\n", ":2: column 'F' is ''");
  expect_refused("F\n\"1,5\"\n", ":2: column 'F' is '1,5'");
  expect_refused("F\n1\n2\nnan\n", ":4: column 'F' is 'nan': a finite number is needed");
  expect_refused("F\n-inf\n", ":2: column 'F' is '-inf': a finite number");
  expect_refused("F\n1e999\n", ":2: column 'F' is '1e999': a finite number");
  expect_refused("F\n" + std::string(5000, 'x') + "\n", "xxx…'");
}

TEST_F(CsvImport, RefusesTimesThatAreNotTheRates) {
  // Half the rate: the first step already shows it.
  expect_refused(
      "t,F\n0.000,1\n0.002,1\n0.004,1\n",
      ":3: column 't' is 0.002 s in row 2, 0.001 s expected at 1000 Hz; the whole column runs at 500 Hz");
  // A row is missing in the middle.
  expect_refused("time,F\n0.000,1\n0.001,1\n0.003,1\n0.004,1\n", ":4: column 'time' is 0.003 s in row 3");
  expect_refused("time_s,F\n0.000,1\n0.000,1\n", ":3: column 'time_s' is 0 s in row 2");
  expect_refused("t_s,F\n0.000,1\nsoon,1\n", ":3: column 't_s' is 'soon'");
}

// A step of 0.001 s printed to 0.01 s: no single step can be wrong, the sum of them can.
TEST_F(CsvImport, WrongRateIsSeenThroughCoarseDigits) {
  std::string right = "t,F\n";
  std::string wrong = "t,F\n";
  for (int i = 0; i < 200; ++i) {
    right += fmt::format("{:.2f},1\n", i * 0.001);
    wrong += fmt::format("{:.2f},1\n", i * 0.0012);
  }
  EXPECT_TRUE(import(right));
  expect_refused(wrong, "the whole column runs at 8");
}

// %g with six digits: 0.00285714 … 123.457. Each time is as good as its own digits.
TEST_F(CsvImport, TimesMayBePrintedWithAFixedNumberOfSignificantDigits) {
  std::string content = "t,F\n";
  for (int i = 0; i < 50'000; ++i) content += fmt::format("{:g},1\n", i / 350.0);
  const auto record = import(content, 350.0);
  EXPECT_TRUE(record) << record.error().message;
  EXPECT_FALSE(import(content, 350.01));
}

TEST_F(CsvImport, NamedTimeColumnMustBeThere) {
  request_.time_column = "clock";
  expect_refused("t,F\n0,1\n", "there is no column 'clock'");
  const auto record = import("clock,t,F\n5.000,9,1\n5.001,9,1\n");
  EXPECT_TRUE(record) << record.error().message;  // t is not looked at.
}

TEST_F(CsvImport, RefusesFactsThatCannotBe) {
  for (const double bad : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    const auto record = import("F\n1\n", bad);
    ASSERT_FALSE(record) << bad;
    EXPECT_THAT(record.error().message, HasSubstr("must be positive and finite"));
  }
  request_.tester.sled_mass_kg = -2.0;
  const auto record = import("F\n1\n");
  ASSERT_FALSE(record);
  EXPECT_EQ(record.error().message, "sled mass -2 kg: must be positive and finite");
}

TEST_F(CsvImport, MissingFileIsAUsageError) {
  request_.path = folder_ / "missing.csv";
  request_.column = "F";
  request_.rate_Hz = 1.0;
  const auto record = read_csv(request_);
  ASSERT_FALSE(record);
  EXPECT_EQ(record.error().exit_status(), 2);
}

std::filesystem::path shared_data() {
  const char* given = std::getenv("STICKSLIP_SHARED_DATA");
  return given != nullptr ? given : STICKSLIP_SOURCE_DIR "/../shared/data";
}

TEST(CsvImportOfRealTraces, KeepsEveryValueOfTwoMinutes) {
  const auto trace = shared_data() / "paper_k168_v42.csv";
  if (!std::filesystem::exists(trace)) {
    const char* ci = std::getenv("CI");
    if (ci != nullptr && std::string{ci} == "true") FAIL() << trace << " is missing";
    GTEST_SKIP() << trace << " is missing";
  }
  CsvImportRequest request;
  request.path = trace;
  request.column = "F_over_mg";
  request.rate_Hz = 2000.0;
  const auto record = read_csv(request);
  ASSERT_TRUE(record) << record.error().message;
  EXPECT_EQ(record->raw.size(), 120'000U);
  EXPECT_EQ(record->raw.front(), 0.2520662);

  const TemporaryFolder folder;
  const auto published = record::publish_record(*record, folder / "a.h5");
  ASSERT_TRUE(published) << published.error().message;
  const auto read = record::read_record(folder / "a.h5");
  ASSERT_TRUE(read) << read.error().message;
  test::expect_same_record(*read, *record);
}

}  // namespace
}  // namespace stickslip
