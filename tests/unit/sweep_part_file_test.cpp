#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <optional>

#include "cli/sweep/part_file.hpp"

#include "core/record/sweep_file.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/support/sweep_samples.hpp"

namespace stickslip::sweep {
namespace {

using analysis::Estimate;
using record::SweepFacts;
using record::SweepRun;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

SweepRun run_number(std::int64_t number) {
  SweepRun run;
  run.number = number;
  run.results.regime = model::Regime::kRingDown;
  run.results.mu_s = Estimate::of(0.1 + static_cast<double>(number) / 3.0, 1e-300);
  run.results.mu_k = Estimate::of(-0.0);
  run.results.delta_mu = Estimate::none("fewer than \"three\" slips — β");
  run.truth.mu_s = 0.35;
  run.truth.mu_k = 0.30;
  run.truth.seed = 0xffff'ffff'ffff'fff0ULL + static_cast<std::uint64_t>(number);
  run.truth.regime = model::Regime::kMixed;
  run.true_cycle_count = 7;
  return run;
}

class SweepPartFile : public testing::Test {
 protected:
  base::Result<PartFile> open(const SweepFacts& facts = test::small_facts()) {
    return PartFile::open(file_, facts, clock_);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "sweep.h5.part";
  test::ManualClock clock_;
};

TEST_F(SweepPartFile, GoesOnWhereItStopped) {
  {
    auto part = open();
    ASSERT_TRUE(part) << part.error().message;
    EXPECT_THAT(part->missing(), ElementsAre(0, 1, 2, 3, 4, 5));
    for (const std::int64_t number : {4, 0}) ASSERT_TRUE(part->append(run_number(number)));
    clock_.advance(std::chrono::seconds{2});  // The next one is synced.
    ASSERT_TRUE(part->append(run_number(2)));
  }
  auto part = open();
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_EQ(part->done_count(), 3);
  EXPECT_THAT(part->missing(), ElementsAre(1, 3, 5));
}

TEST_F(SweepPartFile, GivesBackEachRunBitForBit) {
  auto part = open();
  for (std::int64_t number = 5; number >= 0; --number) ASSERT_TRUE(part->append(run_number(number)));
  const auto table = part->table();
  ASSERT_TRUE(table) << table.error().message;
  record::SweepTable expected{6};
  for (std::int64_t number = 0; number < 6; ++number) expected.set(run_number(number));
  EXPECT_EQ(table->result("mu_s").value, expected.result("mu_s").value);
  EXPECT_EQ(table->result("mu_s").standard_error[5], 1e-300);
  EXPECT_TRUE(std::signbit(table->result("mu_k").value[3]));
  EXPECT_TRUE(std::isnan(table->result("mu_k").standard_error[3]));
  EXPECT_TRUE(std::isnan(table->result("delta_mu").value[0]));
  EXPECT_EQ(table->reasons()[table->result("delta_mu").reason[0]], "fewer than \"three\" slips — β");
  EXPECT_EQ(table->truth("delta_mu").value[0], 0.35 - 0.30);
  EXPECT_EQ(table->truth("cycle_count").value[0], 7.0);
  EXPECT_TRUE(std::isnan(table->truth("amplitude").value[0]));
  EXPECT_EQ(table->seed()[5], 0xffff'ffff'ffff'fff5ULL);
  EXPECT_EQ(model::kRegimeNames[table->regime()[1]].first, model::Regime::kRingDown);
  EXPECT_EQ(model::kRegimeNames[table->true_regime()[1]].first, model::Regime::kMixed);
  ASSERT_TRUE(part->remove());
  EXPECT_FALSE(std::filesystem::exists(file_));
}

TEST_F(SweepPartFile, CutAnywhereKeepsEveryWholeRunAndTakesTheOthersAgain) {
  {
    auto part = open();
    for (const std::int64_t number : {3, 1, 5}) ASSERT_TRUE(part->append(run_number(number)));
  }
  const std::string whole = test::content_of(file_);
  constexpr std::size_t kStep = 101;  // Prime, so that it falls on every kind of place.
  for (std::size_t size = 0; size <= whole.size(); size += kStep) {
    std::ofstream{file_, std::ios::binary} << whole.substr(0, size);
    const auto lines = std::count(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size), '\n');
    auto part = open();
    ASSERT_TRUE(part) << size << ": " << part.error().message;
    EXPECT_EQ(part->done_count(), std::max<std::int64_t>(lines - 1, 0)) << size;
    for (const std::int64_t number : part->missing()) ASSERT_TRUE(part->append(run_number(number)));
    EXPECT_TRUE(part->table());
  }
}

TEST_F(SweepPartFile, DropsWhatADiskLostInTheMiddle) {
  {
    auto part = open();
    for (const std::int64_t number : {3, 1, 5}) ASSERT_TRUE(part->append(run_number(number)));
  }
  std::string text = test::content_of(file_);
  const std::size_t second_run = text.find('\n', text.find('\n') + 1) + 1;
  text.replace(second_run, 20, std::string(20, '\0'));
  std::ofstream{file_, std::ios::binary} << text;
  const auto part = open();
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_THAT(part->missing(), ElementsAre(0, 1, 2, 4, 5));
}

TEST_F(SweepPartFile, OfAnotherSweepIsRefusedWithWhatDiffers) {
  ASSERT_TRUE(open()->append(run_number(0)));
  const std::string before = test::content_of(file_);
  const auto refusal = [&](void (*change)(SweepFacts&)) {
    SweepFacts facts = test::small_facts();
    change(facts);
    const auto part = open(facts);
    if (part) return std::string{};
    EXPECT_EQ(part.error().kind, base::ErrorKind::kUsage);
    EXPECT_THAT(part.error().message, HasSubstr("remove it, or choose another -o"));
    EXPECT_EQ(test::content_of(file_), before);
    return part.error().message;
  };
  EXPECT_THAT(refusal([](SweepFacts& facts) { facts.repeat = 4; }),
              HasSubstr("repeat is 3 there and 4 here"));
  EXPECT_THAT(refusal([](SweepFacts& facts) { facts.seed = 9; }), HasSubstr("seed is 3 there and 9 here"));
  EXPECT_THAT(refusal([](SweepFacts& facts) { facts.version = "2"; }),
              HasSubstr("version is \"1.2.3\" there and \"2\" here"));
  EXPECT_THAT(refusal([](SweepFacts& facts) { facts.axes[0].values[1] = 0.37; }),
              AllOf(HasSubstr("vary is"), HasSubstr("0.36"), HasSubstr("0.37")));
  EXPECT_THAT(refusal([](SweepFacts& facts) { facts.scene_text += "#"; }),
              HasSubstr("the scene's text, with its changes, is another"));
  // What changes no number does not matter.
  EXPECT_THAT(refusal([](SweepFacts& facts) { facts.command = "as before"; }), IsEmpty());
}

TEST_F(SweepPartFile, AStrangersFileIsRefusedAndLeftAlone) {
  for (const char* text : {"mine", "mine\n", "{}\n", "[1]\nmine", "{\"format\": 7}\n"}) {
    std::ofstream{file_, std::ios::binary} << text;
    const auto part = open();
    ASSERT_FALSE(part);
    EXPECT_THAT(part.error().message, HasSubstr("it is no part of a sweep"));
    EXPECT_EQ(test::content_of(file_), text);
  }
}

TEST_F(SweepPartFile, IsWrittenByOneProgramAtATime) {
  const auto mine = open();
  ASSERT_TRUE(mine);
  const auto other = open();
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("another sweep is writing it right now"));
}

TEST(SweepFile, NeverReplacesAFile) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "sweep.h5";
  std::ofstream{file} << "mine";
  const auto published = record::publish_sweep(test::small_facts(), record::SweepTable{6}, file);
  ASSERT_FALSE(published);
  EXPECT_EQ(published.error().kind, base::ErrorKind::kUsage);
  EXPECT_EQ(test::content_of(file), "mine");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path()}, {}), 1) << "nothing is left";
}

// Neither what is being written nor what is built follows a link that somebody laid there.
TEST(SweepFile, FollowsNoLink) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "sweep.h5";
  std::ofstream{folder.path() / "precious"} << "";
  for (const char* link : {"sweep.h5.tmp", "sweep.h5.part"})
    std::filesystem::create_symlink("precious", folder.path() / link);
  const auto clock = base::make_system_clock();
  EXPECT_FALSE(PartFile::open(file.string() + ".part", test::small_facts(), *clock));
  ASSERT_TRUE(record::publish_sweep(test::small_facts(), record::SweepTable{6}, file));
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(file)));
  EXPECT_EQ(test::content_of(folder.path() / "precious"), "");
}

}  // namespace
}  // namespace stickslip::sweep
