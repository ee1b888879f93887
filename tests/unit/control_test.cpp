#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/executor_work_guard.hpp>
#include <nlohmann/json.hpp>

#include "daemon/control/api.hpp"
#include "daemon/control/client.hpp"
#include "daemon/control/server.hpp"

namespace stickslip::daemon {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

Status some_status() {
  Status status;
  status.state = "acquiring";
  status.scan_count = 42;
  status.board.emplace();
  status.board->scan_rate_granted_Hz = 350.0;
  status.latest_test.emplace();
  status.latest_test->number = 7;
  status.latest_test->results.mu_s = friction::Estimate::of(0.35);
  status.latest_test->results.mu_k = friction::Estimate::none("no slip");
  status.live.emplace();
  status.live->phase = friction::Phase::kCycles;
  status.live->regime = friction::Regime::kStickSlip;
  status.live->latest.emplace();
  status.live->latest->S = 0.36;
  status.storage.kind = StorageState::Kind::kShort;
  status.storage.room_h = 0.1;
  status.storage.why = "room for 6 min of tests, 10 are wanted";
  return status;
}

TEST(ControlApi, TellsTheStatusByTheNamesOfTheRecord) {
  const HttpReply reply = make_api(some_status)({"GET", "/v1/status", ""});
  EXPECT_EQ(reply.status, 200);
  const json status = json::parse(reply.body);
  EXPECT_EQ(status["state"], "acquiring");
  EXPECT_EQ(status["scan_count"], 42);
  EXPECT_EQ(status["board"]["scan_rate_granted"], 350.0);
  EXPECT_EQ(status["current_test"], nullptr);
  EXPECT_EQ(status["live"]["phase"], "cycles");
  EXPECT_EQ(status["live"]["regime"], "stick-slip");
  EXPECT_EQ(status["live"]["latest_cycle"]["mu_s"], 0.36);
  EXPECT_EQ(status["live"]["latest_cycle"]["mu_k"], nullptr);
  EXPECT_EQ(status["storage"]["state"], "short");
  EXPECT_EQ(status["storage"]["room_h"], 0.1);
  EXPECT_EQ(status["storage"]["waiting_size"], 0);
  EXPECT_EQ(status["storage"]["why"], "room for 6 min of tests, 10 are wanted");
  EXPECT_EQ(status["storage"]["to_do"], nullptr);
  EXPECT_EQ(status["latest_test"]["results"]["mu_s"], 0.35);
  EXPECT_EQ(status["latest_test"]["results"]["mu_k"], nullptr);
}

TEST(ControlApi, RefusesWithTheReason) {
  const HttpHandler api = make_api(some_status);
  const HttpReply absent = api({"GET", "/v1/nothing\x01", ""});
  EXPECT_EQ(absent.status, 404);
  EXPECT_EQ(json::parse(absent.body)["error"], "there is nothing at /v1/nothing?; there is: GET /v1/status");
  const HttpReply method = api({"POST", "/v1/status", ""});
  EXPECT_EQ(method.status, 405);
  EXPECT_EQ(method.allow, "GET");
  EXPECT_EQ(json::parse(method.body)["error"], "POST is not allowed at /v1/status; GET is");
}

// Names of devices and files come from outside and may be no UTF-8.
TEST(ControlApi, SurvivesNamesThatAreNoText) {
  const HttpReply reply = make_api([] {
    Status status;
    status.detail = "\xff";
    return status;
  })({"GET", "/v1/status", ""});
  EXPECT_TRUE(json::accept(reply.body));
}

/// A server in a temporary folder, run by a thread of its own.
class ControlServerTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "stickslip-control-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    socket_ = folder_ / "s";
  }
  void TearDown() override {
    guard_.reset();
    io_.stop();
    if (thread_.joinable()) thread_.join();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }
  void serve(HttpLimits limits = {}) {
    auto server = ControlServer::listen(io_, socket_, make_api(some_status), limits);
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
    thread_ = std::thread{[this] { io_.run(); }};
  }

  /// Sends bytes as they are; returns all that comes back until the server closes.
  std::string raw(const std::string& bytes) {
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_.string().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
    std::string answer;
    char buffer[4096];
    for (ssize_t got = 0; (got = ::recv(descriptor, buffer, sizeof buffer, 0)) > 0;) {
      answer.append(buffer, static_cast<std::size_t>(got));
    }
    ::close(descriptor);
    return answer;
  }

  std::filesystem::path folder_;
  std::filesystem::path socket_;
  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> guard_{io_.get_executor()};
  std::unique_ptr<ControlServer> server_;
  std::thread thread_;
};

TEST_F(ControlServerTest, AnswersOverTheSocketWhichOnlyOwnerAndGroupMayUse) {
  serve();
  struct stat facts {};
  ASSERT_EQ(::stat(socket_.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U, 0660U);
  const base::Result<HttpReply> reply = request(socket_, {"GET", "/v1/status", ""}, 10s);
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(json::parse(reply->body)["scan_count"], 42);
}

TEST_F(ControlServerTest, RefusesWhatIsTooLongOrNoHttp) {
  HttpLimits limits;
  limits.header_size = 256;
  limits.body_size = 16;
  serve(limits);
  EXPECT_THAT(raw("GET /v1/status HTTP/1.1\r\nX: " + std::string(1000, 'x') + "\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 431 "));
  EXPECT_THAT(raw("GET /v1/status HTTP/1.1\r\nContent-Length: 17\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(raw("\x01\x02\x03\r\n\r\n"), testing::StartsWith("HTTP/1.1 400 "));
}

TEST_F(ControlServerTest, LeavesAClientThatSaysNothing) {
  HttpLimits limits;
  limits.time = 20ms;
  serve(limits);
  EXPECT_EQ(raw("GET /v1/st"), "");
}

TEST_F(ControlServerTest, RefusesMoreConnectionsThanItsLimit) {
  HttpLimits limits;
  limits.connections = 0;
  serve(limits);
  EXPECT_FALSE(request(socket_, {"GET", "/v1/status", ""}, 10s));
}

TEST_F(ControlServerTest, ReplacesALeftOverSocketButNothingElse) {
  {
    boost::asio::io_context dead;
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_.string().copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::close(descriptor);
  }
  serve();
  const auto second = ControlServer::listen(io_, socket_, make_api(some_status));
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, testing::HasSubstr("another process is listening"));

  std::ofstream{folder_ / "file"} << "x";
  const auto file = ControlServer::listen(io_, folder_ / "file", make_api(some_status));
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().exit_status(), 2);
  const auto longest = ControlServer::listen(io_, folder_ / std::string(200, 'x'), make_api(some_status));
  ASSERT_FALSE(longest);
  EXPECT_EQ(longest.error().exit_status(), 2);
}

TEST(ControlClient, SaysThatNobodyAnswers) {
  const base::Result<HttpReply> reply = request("/nonexistent/s", {"GET", "/", ""}, 1s);
  ASSERT_FALSE(reply);
  EXPECT_THAT(reply.error().message, testing::HasSubstr("is stickslipd running"));
}

}  // namespace
}  // namespace stickslip::daemon
