// Reports by a program of its own: here a shell's script stands for it.

#include "daemon/page/report_jobs.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "core/record/file.hpp"
#include "tests/support/record_samples.hpp"

namespace stickslip::daemon {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

const ReportedBatch kLiner{"20261122T180301Z", "liner (20261122T180301Z)"};
const ReportedBatch kFluting{"20261122T180302Z", "--fluting (20261122T180302Z)"};

class ReportJobsTest : public testing::Test {
 protected:
  // As the daemon does.
  ReportJobsTest() { static_cast<void>(std::signal(SIGXFSZ, SIG_IGN)); }

  std::string script(const std::string& text) {
    const std::filesystem::path file = folder_.path() / "program";
    std::ofstream{file} << "#!/bin/sh\n" << text << '\n';
    ::chmod(file.c_str(), S_IRWXU);
    return file.string();
  }
  page::ReportJobs::Parts parts(const std::string& program) {
    return {.io = io_, .folder = "/records", .program = program};
  }
  /// Runs until all is answered.
  base::Result<std::string> made(page::ReportJobs& jobs, std::span<const ReportedBatch> batches,
                                 ReportForm form, std::string_view pool = {}) {
    std::optional<base::Result<std::string>> got;
    jobs.make(batches, form, pool, [&got](base::Result<std::string> text) { got = std::move(text); });
    io_.restart();
    io_.run();
    return got.value_or(base::failure("no answer"));
  }
  std::string refused(page::ReportJobs::Parts parts) {
    page::ReportJobs jobs{std::move(parts)};
    const auto text = made(jobs, {&kLiner, 1}, ReportForm::kPage);
    return text ? "made" : text.error().message;
  }

  test::TemporaryFolder folder_;
  boost::asio::io_context io_;
};

TEST_F(ReportJobsTest, AsksForIdentifiersInTheFolderOfTheRecordsAndForNothingElse) {
  page::ReportJobs jobs{parts(script(R"(for word; do echo "$word"; done)"))};
  const std::array both{kLiner, kFluting};
  EXPECT_EQ(made(jobs, {&kLiner, 1}, ReportForm::kPage).value_or(""),
            "report\n--batch=20261122T180301Z\n--output=-\n/records\n");
  EXPECT_EQ(made(jobs, {&kLiner, 1}, ReportForm::kCsv).value_or(""),
            "report\n--batch=20261122T180301Z\n--csv=-\n/records\n");
  EXPECT_EQ(made(jobs, {&kLiner, 1}, ReportForm::kJson, "grades,regimes").value_or(""),
            "report\n--batch=20261122T180301Z\n--pool=grades,regimes\n--json\n/records\n");
  EXPECT_EQ(made(jobs, both, ReportForm::kJson).value_or(""),
            "compare\n--batch-a=20261122T180301Z\n--label-a=liner (20261122T180301Z)\n"
            "--batch-b=20261122T180302Z\n--label-b=--fluting (20261122T180302Z)\n--json\n/records\n");
}

TEST_F(ReportJobsTest, ATraceIsExportedAndWaitsForNoReport) {
  const std::filesystem::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), S_IRWXU), 0);
  page::ReportJobs jobs{parts(script("[ $1 = report ] && exec /bin/cat " + pipe.string() + "\necho \"$@\""))};
  std::string report;
  std::string trace;
  jobs.make({&kLiner, 1}, ReportForm::kPage, "",
            [&report](base::Result<std::string> text) { report = text.value_or("none"); });
  jobs.trace({.record = "/records/a.h5", .points = 80, .from_s = 1.25, .to_s = 2.0},
             [&trace](base::Result<std::string> text) { trace = text.value_or("none"); });
  while (trace.empty()) io_.run_one();
  EXPECT_EQ(trace, "export --json --points=80 --from=1.25 --to=2 /records/a.h5\n");
  EXPECT_EQ(report, "");
  std::ofstream{pipe} << "whole";  // Returns when the child has opened it.
  io_.run();
  EXPECT_EQ(report, "whole");
}

TEST_F(ReportJobsTest, OneIsMadeAtATimeAndItsEndLetsTheNextBegin) {
  const std::filesystem::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), S_IRWXU), 0);
  page::ReportJobs jobs{parts(script("exec /bin/cat " + pipe.string()))};
  std::string first;
  jobs.make({&kLiner, 1}, ReportForm::kPage, "",
            [&first](base::Result<std::string> text) { first = text.value_or("none"); });
  std::optional<base::ErrorKind> second;
  jobs.make({&kLiner, 1}, ReportForm::kPage, "",
            [&second](const base::Result<std::string>& text) { second = text.error().kind; });
  EXPECT_EQ(second, base::ErrorKind::kBusy);
  std::ofstream{pipe} << "whole";  // Returns when the child has opened it.
  io_.run();
  EXPECT_EQ(first, "whole");
  jobs.make({&kLiner, 1}, ReportForm::kPage, "",
            [&first](base::Result<std::string> text) { first = text.value_or("none"); });
  std::ofstream{pipe} << "again";
  io_.restart();
  io_.run();
  EXPECT_EQ(first, "again");
}

TEST_F(ReportJobsTest, WhatTakesTooLongIsEnded) {
  page::ReportJobs::Parts hasty = parts(script("exec /bin/sleep 100000"));
  hasty.longest = 50ms;
  EXPECT_THAT(refused(std::move(hasty)), HasSubstr("took longer than 0.05 s"));
}

TEST_F(ReportJobsTest, WhatIsTooLargeIsEnded) {
  page::ReportJobs::Parts narrow = parts(script("exec /usr/bin/head -c 2000000 /dev/zero"));
  narrow.largest = 1U << 20U;
  EXPECT_THAT(refused(std::move(narrow)), HasSubstr("larger than 1 MiB"));
}

TEST_F(ReportJobsTest, TellsWhyThereIsNone) {
  EXPECT_EQ(refused(parts(script("echo 'stickslip: batch x has no test yet' >&2; exit 2"))),
            "there is no report: batch x has no test yet");
  EXPECT_EQ(refused(parts(script("kill -9 $$"))), "signal 9 ended the program that makes the report");
  EXPECT_THAT(refused(parts("/no/such/stickslip")),
              HasSubstr("/no/such/stickslip: there is no such program"));
}

TEST_F(ReportJobsTest, ASearchIsThatOfFindWithTheIndexOfThisUser) {
  const RecordSearch search{.conditions = {{"sample", "--liner"}, {"where", "S=0.3:"}}, .most = 5};
  const auto found = [&](const std::string& text) {
    page::ReportJobs jobs{parts(script(text))};
    std::optional<base::Result<std::string>> got;
    jobs.find(search, [&got](base::Result<std::string> answer) { got = std::move(answer); });
    io_.restart();
    io_.run();
    return got.value_or(base::failure("no answer"));
  };
  EXPECT_EQ(found(R"(for word; do echo "$word"; done)").value_or(""),
            "find\n--json\n--sort=date\n--reverse\n--most=5\n--sample=--liner\n--where=S=0.3:\n/records\n");
  ::setenv("XDG_CACHE_HOME", "/some/cache", 1);
  EXPECT_EQ(found("echo $XDG_CACHE_HOME").value_or(""), "/some/cache\n");
  ::unsetenv("XDG_CACHE_HOME");
  // Status 3: nothing is found, and the answer says so.
  EXPECT_EQ(found("echo '{}'; exit 3").value_or(""), "{}\n");
  const auto wrong = found("echo 'stickslip: --where S=9: must be RESULT=LOWEST:HIGHEST' >&2; exit 2");
  EXPECT_EQ(wrong.error().kind, base::ErrorKind::kUsage);
  EXPECT_EQ(wrong.error().message, "where S=9: must be RESULT=LOWEST:HIGHEST");
  const auto none = found("echo 'stickslip: /records: name a folder of records' >&2; exit 2");
  EXPECT_EQ(none.error().kind, base::ErrorKind::kFailure);
}

TEST_F(ReportJobsTest, ARecordIsFoundByItsOwnNameAlone) {
  const std::filesystem::path records = folder_.path() / "records";
  std::filesystem::create_directories(records / "2026");
  for (const char* const name : {"records/a.h5", "records/2026/b.h5", "records/batches.jsonl", "outside.h5"})
    std::ofstream{folder_.path() / name} << "x";
  std::filesystem::create_symlink(folder_.path() / "outside.h5", records / "link.h5");
  std::filesystem::create_directory_symlink(folder_.path(), records / "up");
  const page::ReportJobs jobs{{.io = io_, .folder = records, .program = ""}};
  EXPECT_EQ(jobs.record("a.h5").value_or(""), std::filesystem::canonical(records) / "a.h5");
  EXPECT_EQ(jobs.record("2026/b.h5").value_or(""), std::filesystem::canonical(records) / "2026/b.h5");
  for (const std::string& name :
       {std::string{"../outside.h5"}, std::string{"./a.h5"}, std::string{"2026/../a.h5"},
        std::string{"link.h5"}, std::string{"up/outside.h5"}, std::string{"c.h5"},
        std::string{"batches.jsonl"}, std::string{}, std::string{"a.h5\0", 5}, (records / "a.h5").string()}) {
    EXPECT_FALSE(jobs.record(name)) << name;
  }
}

TEST_F(ReportJobsTest, ItsEndEndsWhatIsBeingMade) {
  const std::filesystem::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), S_IRWXU), 0);
  auto jobs = std::make_optional<page::ReportJobs>(parts(script("exec /bin/cat " + pipe.string())));
  jobs->make({&kLiner, 1}, ReportForm::kPage, "", [](const base::Result<std::string>&) { FAIL(); });
  // Returns when the child reads; while this is open it goes on.
  const record::Descriptor writer{::open(pipe.c_str(), O_WRONLY | O_CLOEXEC)};
  ASSERT_TRUE(writer.open());
  jobs.reset();
  // Nobody reads any more.
  EXPECT_EQ(::open(pipe.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC), -1);
  EXPECT_EQ(errno, ENXIO);
}

}  // namespace
}  // namespace stickslip::daemon
