#include "daemon/runtime/watchdog.hpp"

#include <gmock/gmock.h>

#include <map>

namespace stickslip::runtime {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class Watched : public testing::Test {
 protected:
  WatchedPart part(const std::string& name, int patience = 0) {
    return {name, [this, name] { return pulses_[name]; }, patience};
  }
  void move(const std::string& name) { ++pulses_[name].count; }

  std::map<std::string, Pulse> pulses_{{"a", {1}}, {"b", {1}}};
};

TEST_F(Watched, WhatMovesDoesNotHang) {
  PulseWatch watch{{part("a"), part("b")}};
  for (int look = 0; look < 10; ++look) {
    EXPECT_THAT(watch.look(), IsEmpty());
    move("a");
    move("b");
  }
}

TEST_F(Watched, WhatStandsStillHangsUntilItMoves) {
  PulseWatch watch{{part("a"), part("b")}};
  EXPECT_THAT(watch.look(), IsEmpty());
  move("a");
  EXPECT_THAT(watch.look(), ElementsAre("b"));
  EXPECT_THAT(watch.look(), ElementsAre("a", "b"));
  move("b");
  EXPECT_THAT(watch.look(), ElementsAre("a"));
  EXPECT_THAT(watch.hanging(), ElementsAre("a"));
  move("a");
  EXPECT_THAT(watch.look(), ElementsAre("b"));
}

TEST_F(Watched, WhatIsAtRestDoesNotHang) {
  PulseWatch watch{{part("a")}};
  EXPECT_THAT(watch.look(), IsEmpty());
  pulses_["a"].at_rest = true;
  for (int look = 0; look < 10; ++look) EXPECT_THAT(watch.look(), IsEmpty());
  // From when it should move again.
  pulses_["a"].at_rest = false;
  EXPECT_THAT(watch.look(), ElementsAre("a"));
}

TEST_F(Watched, PatienceIsCountedInIntervals) {
  PulseWatch watch{{part("a", 2)}};
  EXPECT_THAT(watch.look(), IsEmpty());
  for (int look = 0; look < 2 * PulseWatch::kLooksPerInterval; ++look) EXPECT_THAT(watch.look(), IsEmpty());
  EXPECT_THAT(watch.look(), ElementsAre("a"));
}

TEST_F(Watched, NobodyLooksWhereNobodyWatches) {
  boost::asio::io_context io;
  int fed = 0;
  Watchdog watchdog{io, std::chrono::microseconds{0}, {part("a")}, {[&fed] { ++fed; }, {}}};
  watchdog.start();
  EXPECT_EQ(io.run(), 0U);
  EXPECT_EQ(fed, 0);
}

TEST_F(Watched, IsFedWhileAllMoveAndTellsOnceWhatHangs) {
  boost::asio::io_context io;
  std::vector<std::string> told;
  int fed = 0;
  int looks = 0;
  WatchedPart moving{"moving", [&looks] { return Pulse{static_cast<std::uint64_t>(++looks)}; }};
  Watchdog watchdog{io,
                    std::chrono::microseconds{1000},
                    {moving, part("a", 1)},
                    {[&fed] { ++fed; },
                     [&told](const std::vector<std::string>& parts) {
                       told.push_back(parts.empty() ? "" : parts.front());
                     }}};
  watchdog.start();
  EXPECT_EQ(fed, 1);
  while (looks < 10) io.run_one();
  // The first look knows no look before it; then four stand still with patience, the sixth without.
  EXPECT_THAT(told, ElementsAre("a"));
  EXPECT_EQ(fed, 6);
  move("a");
  while (looks < 11) io.run_one();
  EXPECT_THAT(told, ElementsAre("a", ""));
  EXPECT_EQ(fed, 7);
}

}  // namespace
}  // namespace stickslip::runtime
