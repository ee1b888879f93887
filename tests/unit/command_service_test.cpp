// Commands between the control interface and the bench: what is refused before the bench is asked, and what
// had been done already.

#include "daemon/runtime/command_service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "tests/support/faulty_disk.hpp"
#include "tests/support/record_samples.hpp"
#include "tests/unit/paper_bench.hpp"

namespace stickslip::daemon {
namespace {

using Kind = Command::Kind;

/// Waits for the storage to say that it is short.
class HeardOfRoom final : public EventReceiver {
 public:
  void storage_short(std::string_view) override {
    const std::lock_guard lock{mutex_};
    short_ = true;
    news_.notify_all();
  }
  void wait_until_short() {
    std::unique_lock lock{mutex_};
    news_.wait(lock, [this] { return short_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable news_;
  bool short_ = false;
};

class CommandServiceTest : public testing::Test {
 protected:
  Outcome ask(const Command& command) {
    std::optional<Outcome> got;
    commands_.command(command, [&got](const Outcome& outcome) { got = outcome; });
    EXPECT_TRUE(got) << "without a session it is answered at once";
    return got.value_or(Outcome{});
  }

  test::TemporaryFolder folder_;
  test::FaultyDisk disk_;
  HeardOfRoom heard_;
  TestLog tests_;
  io::DaemonConfig config_;
  storage::Storage storage_{{.folder = folder_.path(), .calls = &disk_},
                            [](const std::filesystem::path& journal, std::optional<std::int64_t>) {
                              return base::Result<record::Finalised>{{journal, {}, 0, {}}};
                            },
                            tests_,
                            heard_};
  runtime::CalibrationService calibrations_{{.config = config_,
                                             .storage = storage_,
                                             .events = heard_,
                                             .session = [] { return nullptr; },
                                             .on_main = [](const std::function<void()>&) {},
                                             .date_ns = [] { return 0; },
                                             .now_ns = [] { return 0; }}};
  PaperBatches batches_;
  PaperReports reports_;
  runtime::CommandService commands_{{.config = config_,
                                     .tests = tests_,
                                     .storage = storage_,
                                     .calibrations = calibrations_,
                                     .status = [] { return Status{}; },
                                     .session = [] { return nullptr; },
                                     .on_main = [](const std::function<void()>&) {},
                                     .batches = &batches_,
                                     .reports = &reports_,
                                     .trend = {}}};
};

TEST_F(CommandServiceTest, WithoutABoardCommandsAreRefused) {
  for (const Kind kind : {Kind::kArm, Kind::kStart, Kind::kStop, Kind::kMark, Kind::kTare}) {
    EXPECT_EQ(ask({kind, "ada", "x", {}}).report.refusal,
              "no scans come from the board; stickslip status says why");
  }
}

TEST_F(CommandServiceTest, WithoutABoardNoCalibrationBegins) {
  std::string refusal;
  const auto told = [&refusal](const CalibrationRefusal& refused) { refusal = refused.why; };
  calibrations_.begin("ada", {}, told);
  EXPECT_THAT(refusal, testing::HasSubstr("names no folder"));
  config_.bench.calibration_folder = folder_.path();
  calibrations_.begin("ada", {}, told);
  EXPECT_THAT(refusal, testing::HasSubstr("no scans come from the board"));
  EXPECT_FALSE(calibrations_.why_no_test());
  calibrations_.weigh(0.0, told);
  EXPECT_THAT(refusal, testing::HasSubstr("begin one first"));
  EXPECT_THAT(calibrations_.undo(), testing::HasSubstr("begin one first"));
  EXPECT_THAT(calibrations_.give_up(), testing::HasSubstr("begin one first"));
}

TEST_F(CommandServiceTest, AShortDiskRefusesTestsThatSomebodyAsksForAndNothingElse) {
  disk_.set_room(1'000'000);
  storage_.use(test::sample_header(), nullptr);
  heard_.wait_until_short();
  EXPECT_THAT(ask({Kind::kStart, "ada", {}, {}}).report.refusal, testing::HasSubstr("room for"));
  EXPECT_THAT(ask({Kind::kArm, "ada", {}, {}}).report.refusal, testing::HasSubstr("room for"));
  EXPECT_THAT(ask({Kind::kStop, "ada", {}, {}}).report.refusal, testing::HasSubstr("no scans"));
}

TEST_F(CommandServiceTest, ThePlanIsKeptForTheNextSession) {
  Plan plan;
  plan.sample.name = "liner";
  plan.pull_speed_m_per_s = 0.01;
  commands_.set_plan(plan);
  EXPECT_EQ(commands_.plan(), plan);
  EXPECT_EQ(config_.sample.name, "liner");
}

/// Readings are coefficients, 100 scans/s.
class CarryOutTest : public testing::Test {
 protected:
  static pipeline::Processor make() {
    pipeline::ProcessorSettings settings;
    settings.segmenter.scan_rate_Hz = 100.0;
    settings.analysis.scan_rate_Hz = 100.0;
    settings.automatic = false;
    settings.clock_is_real = false;
    daq::BoardInfo board;
    board.quantity = daq::RawQuantity::kCoefficient;
    return {settings, {board, {}, 1.0}, {}};
  }
  void feed(double force) {
    daq::ScanBlock block;
    block.first = next_;
    block.count = 50;
    block.raw.fill(force);
    next_ += 50;
    processor_.process(block, daq::GapCause::kUnknown);
  }
  Outcome ask(Kind kind, std::optional<std::int64_t> test) {
    return runtime::carry_out({kind, "ada", "x", test}, processor_);
  }

  daq::ScanIndex next_ = 0;
  pipeline::Processor processor_ = make();
};

TEST_F(CarryOutTest, ATestThatIsNamedIsBegunOnceAndEndedOnce) {
  feed(0.0);
  EXPECT_THAT(ask(Kind::kStart, 2).report.refusal, testing::HasSubstr("the next is test 1"));
  EXPECT_THAT(ask(Kind::kStop, 1).report.refusal, testing::HasSubstr("has not begun"));
  EXPECT_FALSE(ask(Kind::kStart, 1).already);
  EXPECT_TRUE(ask(Kind::kStart, 1).already) << "before its first scan";
  feed(0.3);
  EXPECT_TRUE(ask(Kind::kStart, 1).already);
  EXPECT_THAT(ask(Kind::kStart, std::nullopt).report.refusal, testing::HasSubstr("a test is running"));
  EXPECT_THAT(ask(Kind::kStop, 2).report.refusal, testing::HasSubstr("has not begun"));
  const Outcome stopped = ask(Kind::kStop, 1);
  EXPECT_EQ(stopped.report.refusal, "");
  EXPECT_FALSE(stopped.already);
  EXPECT_TRUE(ask(Kind::kStop, 1).already);
  EXPECT_TRUE(ask(Kind::kStart, 1).already) << "it has been, and is over";
  feed(0.0);
  EXPECT_EQ(processor_.bench(), pipeline::BenchState::kIdle);
  EXPECT_FALSE(ask(Kind::kStart, 2).already);
}

}  // namespace
}  // namespace stickslip::daemon
