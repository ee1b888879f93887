// Programs that are asked, and the one that does with SciPy what others do.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <string>

#include "cli/accuracy_report/scipy_chain.hpp"
#include "io/child_process.hpp"

namespace {

using namespace stickslip;

TEST(ChildProcess, AnswersWhatItIsAsked) {
  // More than a pipe holds.
  const std::string text(1'000'000, 'x');
  const auto answer = io::ask_program("/bin/cat", {"-"}, text);
  ASSERT_TRUE(answer && *answer);
  EXPECT_EQ((*answer)->status, 0);
  EXPECT_EQ((*answer)->output, text);
  EXPECT_EQ((*answer)->errors, "");
}

TEST(ChildProcess, TellsHowItEnded) {
  const auto refused = io::ask_program("/bin/sh", {"-c", "echo no >&2; exit 3"}, "");
  ASSERT_TRUE(refused && *refused);
  EXPECT_EQ((*refused)->status, 3);
  EXPECT_EQ((*refused)->errors, "no\n");
  const auto killed = io::ask_program("/bin/sh", {"-c", "kill -9 $$"}, "");
  ASSERT_TRUE(killed && *killed);
  EXPECT_EQ((*killed)->status, 128 + 9);
}

TEST(ChildProcess, IsKilledAfterTheLongestTime) {
  // Never ends by itself: it stops.
  const auto hanging = io::ask_program("/bin/sh", {"-c", "kill -STOP $$"}, "", std::chrono::milliseconds{0});
  ASSERT_FALSE(hanging);
  EXPECT_EQ(hanging.error().message, "/bin/sh did not end within 0 s and was killed");
  const auto quick = io::ask_program("/bin/cat", {"-"}, "in time", std::chrono::minutes{10});
  ASSERT_TRUE(quick && *quick);
  EXPECT_EQ((*quick)->output, "in time");
}

TEST(ChildProcess, MayNotBeThere) {
  const auto answer = io::ask_program("/no/such/program", {}, "");
  ASSERT_TRUE(answer);
  EXPECT_FALSE(*answer);
}

TEST(ChildProcess, HasNothingOfTheUser) {
  const auto answer = io::ask_program("/usr/bin/env", {}, "");
  ASSERT_TRUE(answer && *answer);
  EXPECT_EQ((*answer)->output, "LC_ALL=C.UTF-8\n");
}

// A cosine of amplitude 1, 20 scans a period with one on the maximum: its mean from peak to peak is 0, and
// the median of five takes 1 − cos(2π/20) = 5 % off the peak, of which the cubic over five gives a part back.
TEST(ScipyChain, FindsTheAmplitudeOfACosine) {
  accuracy::TierScene scene{350.0, 17.5, {{}}};
  for (int k = 0; k < 400; ++k)
    scene.tests.front().push_back(std::cos(2.0 * std::numbers::pi * (k / 20.0 + 0.3)));
  const auto outcomes = accuracy_report::run_scipy_chain({&scene, 1});
  if (!outcomes) {
    ASSERT_NE(outcomes.error().message.find("not installed"), std::string::npos) << outcomes.error().message;
    GTEST_SKIP() << outcomes.error().message;
  }
  ASSERT_EQ(outcomes->size(), 1U);
  // 20 peaks; the first is left out, and the last begins no cycle.
  EXPECT_EQ(outcomes->front().estimates.size(), 18U);
  for (const double found : outcomes->front().estimates)
    EXPECT_NEAR(found, 1.0, 1.0 - std::cos(2.0 * std::numbers::pi / 20.0));
  EXPECT_GT(outcomes->front().ns_per_scan, 0.0);
}

}  // namespace
