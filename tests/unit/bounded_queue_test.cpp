#include "core/base/bounded_queue.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace stickslip::base {
namespace {

constexpr std::chrono::milliseconds kPatient{60'000};

TEST(BoundedQueue, WhatWasPutCannotBeHadBeforeItIsAnnounced) {
  BoundedQueue<int> queue{4};
  queue.put(1);
  queue.put(2);
  int item = 0;
  EXPECT_FALSE(queue.pop(item, std::chrono::milliseconds{0}));
  queue.announce();
  EXPECT_TRUE(queue.pop(item, kPatient));
  EXPECT_EQ(item, 1);
  EXPECT_TRUE(queue.pop(item, kPatient));
  EXPECT_EQ(item, 2);
  EXPECT_FALSE(queue.pop(item, std::chrono::milliseconds{0}));
}

TEST(BoundedQueue, MoreThanHasRoomIsAnnouncedInsteadOfWaitedForEver) {
  constexpr int kItems = 1000;
  BoundedQueue<int> queue{4};
  std::thread producer{[&queue] {
    for (int i = 0; i < kItems; ++i) queue.put(i);
    queue.announce();
  }};
  for (int i = 0; i < kItems; ++i) {
    int item = -1;
    EXPECT_TRUE(queue.pop(item, kPatient));
    EXPECT_EQ(item, i);
  }
  producer.join();
}

}  // namespace
}  // namespace stickslip::base
