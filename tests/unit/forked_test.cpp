#include "daemon/forked.hpp"

#include <gtest/gtest.h>

#include <csignal>

namespace stickslip::daemon {
namespace {

TEST(Forked, WhatDoesNotComeBackIsToldBySignal) {
  const auto crashed = run_forked(
      []() -> std::string {
        std::raise(SIGKILL);
        return "x";
      },
      std::chrono::seconds{5});
  ASSERT_TRUE(crashed);
  EXPECT_EQ(crashed->signal, SIGKILL);
  const auto fine = run_forked([] { return std::string(1'000'000, 'a'); }, std::chrono::seconds{5});
  ASSERT_TRUE(fine);
  EXPECT_FALSE(fine->signal);
  EXPECT_EQ(fine->text.size(), 1'000'000U);
}

}  // namespace
}  // namespace stickslip::daemon
