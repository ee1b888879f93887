#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "core/record/finaliser.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip {
namespace {

constexpr int kSkipped = 77;           // read_record.py has no h5py.
constexpr int kCommandNotFound = 127;  // The shell's.

/// Runs a command; what it says goes to the test's output.
int run(const std::string& command) {
  const int status = std::system(command.c_str());  // NOLINT: fixed commands, names from mkdtemp
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// 0 is success, `missing` a skip unless CI is true, anything else a failure.
void expect_success(const std::string& command, int missing, const std::string& package) {
  const int status = run(command);
  const char* ci = std::getenv("CI");
  if (status == missing && (ci == nullptr || std::string{ci} != "true")) {
    GTEST_SKIP() << package << " is not installed";
  }
  EXPECT_EQ(status, 0) << command;
}

class RecordReaders : public testing::Test {
 protected:
  std::string published(const record::Record& record) {
    const auto path = folder_ / "a.h5";
    const auto result = record::publish_record(record, path);
    EXPECT_TRUE(result) << (result ? "" : result.error().message);
    return path.string();
  }

  // h5py is packaged for Debian's own interpreter, which need not be the first in PATH.
  static void expect_python_reads(const std::string& path, const std::string& signal, std::size_t rows) {
    expect_success("/usr/bin/python3 " STICKSLIP_SOURCE_DIR "/tests/system/read_record.py " + path + " " +
                       signal + " " + std::to_string(rows),
                   kSkipped, "python3-h5py");
  }

  test::TemporaryFolder folder_;
};

TEST_F(RecordReaders, H5pyReadsATest) { expect_python_reads(published(test::sample_record()), "force", 40); }

TEST_F(RecordReaders, H5pyReadsAnImportedTrace) {
  expect_python_reads(published(test::sample_imported()), "coefficient", 20);
}

// Both ways, over records of every kind.
TEST_F(RecordReaders, TheDocumentNamesExactlyWhatIsThere) {
  std::string files;
  const auto add = [&](const std::string& name, const record::Record& record) {
    const auto result = record::publish_record(record, folder_ / name);
    EXPECT_TRUE(result) << (result ? "" : result.error().message);
    files += " " + (folder_ / name).string();
  };
  add("test.h5", test::sample_record());
  record::Record imported = test::sample_imported();
  add("coefficient.h5", imported);
  imported.header.board.quantity = daq::RawQuantity::kForce_N;
  add("force.h5", imported);
  imported.header.board.quantity = daq::RawQuantity::kVolts;
  imported.header.load_cell = daq::LoadCell{2.0, 0.0};
  add("volts.h5", imported);
  record::Record wide = test::sample_record();
  wide.header.board.maxdata = 0xFF'FFFF;
  add("wide.h5", wide);
  expect_success("/usr/bin/python3 " STICKSLIP_SOURCE_DIR "/tests/system/check_names.py " STICKSLIP_SOURCE_DIR
                 "/docs/record-file.md" +
                     files,
                 kSkipped, "python3-h5py");
}

TEST_F(RecordReaders, H5dumpReadsEverything) {
  expect_success("h5dump " + published(test::sample_record()) + " > " + (folder_ / "dump").string(),
                 kCommandNotFound, "hdf5-tools");
}

}  // namespace
}  // namespace stickslip
