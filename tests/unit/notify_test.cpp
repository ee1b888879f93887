#include "daemon/runtime/notify.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "tests/support/record_samples.hpp"

namespace stickslip::runtime {
namespace {

/// A service manager that reads when it is told to.
class Manager {
 public:
  Manager() : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
    const std::string name = (folder_ / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.c_str(), name.size() + 1);
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~Manager() {
    ::unsetenv("NOTIFY_SOCKET");
    ::close(socket_);
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  std::vector<std::string> read() {
    std::vector<std::string> messages;
    std::array<char, 256> room{};
    for (ssize_t size = 0; (size = ::recv(socket_, room.data(), room.size(), 0)) >= 0;) {
      messages.emplace_back(room.data(), static_cast<std::size_t>(size));
    }
    return messages;
  }

 private:
  test::TemporaryFolder folder_;
  int socket_;
};

TEST(Notify, IsAliveAndReadyAgainAfterAReload) {
  Manager manager;
  Notify notify;
  notify.ready();
  notify.alive();
  notify.alive();
  notify.reloading();
  notify.ready();
  const std::vector<std::string> messages = manager.read();
  ASSERT_EQ(messages.size(), 5U);
  EXPECT_EQ(messages[1], "WATCHDOG=1");
  EXPECT_EQ(messages[2], "WATCHDOG=1");
  EXPECT_TRUE(messages[3].starts_with("RELOADING=1\nMONOTONIC_USEC=")) << messages[3];
  EXPECT_EQ(messages[4], "READY=1");
}

TEST(Notify, KnowsHowOftenItIsToBeHeard) {
  EXPECT_EQ(Notify::watchdog_interval().count(), 0);
  ::setenv("WATCHDOG_USEC", "60000000", 1);
  EXPECT_EQ(Notify::watchdog_interval(), std::chrono::seconds{60});
  // Meant for another process.
  ::setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(Notify::watchdog_interval().count(), 0);
  ::unsetenv("WATCHDOG_PID");
  ::unsetenv("WATCHDOG_USEC");
}

TEST(Notify, TellsEachStatusOnce) {
  Manager manager;
  Notify notify;
  notify.status("a");
  notify.status("a");
  notify.ready();
  notify.ready();
  notify.status("b");
  notify.stopping();
  EXPECT_EQ(manager.read(), (std::vector<std::string>{"STATUS=a", "READY=1", "STATUS=b", "STOPPING=1"}));
}

// It would hold up commands and signals.
TEST(Notify, DoesNotWaitForAManagerThatDoesNotRead) {
  Manager manager;
  Notify notify;
  constexpr int kMore = 2000;  // Than any setting of net.unix.max_dgram_qlen that one meets: 10, or 512.
  for (int i = 0; i < kMore; ++i) notify.status(std::to_string(i));
  notify.status("full");
  notify.stopping();
  const std::vector<std::string> heard = manager.read();
  ASSERT_FALSE(heard.empty());
  ASSERT_LT(heard.size(), static_cast<std::size_t>(kMore));
  EXPECT_EQ(heard.front(), "STATUS=0");
  // What was left out is told when there is room.
  notify.status("full");
  EXPECT_EQ(manager.read(), std::vector<std::string>{"STATUS=full"});
}

TEST(Notify, WithoutAManagerNothingHappens) {
  ::unsetenv("NOTIFY_SOCKET");
  Notify notify;
  notify.status("a");
  notify.ready();
  notify.stopping();
}

}  // namespace
}  // namespace stickslip::runtime
