#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <future>
#include <mutex>
#include <semaphore>
#include <string>
#include <thread>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/post.hpp>
#include <nlohmann/json.hpp>

#include "daemon/client/client.hpp"
#include "daemon/client/live_client.hpp"
#include "daemon/control/api.hpp"
#include "daemon/control/server.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/paper_bench.hpp"

namespace stickslip::control {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";

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
    auto server = ControlServer::listen(io_, socket_, make_api(bench_, clock_, lease_), limits, &hub_);
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
    thread_ = std::thread{[this] { io_.run(); }};
  }

  void serve_tcp(HttpLimits limits = {}) {
    auto server = ControlServer::listen_tcp(io_, "127.0.0.1:0", kToken, make_api(bench_, clock_, lease_),
                                            limits, &hub_);
    ASSERT_TRUE(server) << server.error().message;
    server_ = std::move(*server);
    thread_ = std::thread{[this] { io_.run(); }};
  }
  [[nodiscard]] int connected() const {
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    socket_.string().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return descriptor;
  }
  [[nodiscard]] int connected_by_tcp() const {
    const int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(server_->address().substr(10))));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return descriptor;
  }
  static void send(int descriptor, const std::string& bytes) {
    EXPECT_EQ(::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }

  /// The server closes the connection, after what it may have said before.
  [[nodiscard]] static bool is_let_go(int descriptor) {
    constexpr int kLongest_ms = 10'000;
    pollfd one{descriptor, POLLIN, 0};
    std::array<char, 4096> part{};
    while (::poll(&one, 1, kLongest_ms) == 1) {
      if (::recv(descriptor, part.data(), part.size(), 0) <= 0) return true;
    }
    return false;
  }

  /// Sends bytes as they are; returns all that comes back until the server closes.
  [[nodiscard]] static std::string raw(int descriptor, const std::string& bytes, bool half_close = false) {
    // Whoever is refused may find the connection closed already.
    static_cast<void>(::send(descriptor, bytes.data(), bytes.size(), MSG_NOSIGNAL));
    if (half_close) ::shutdown(descriptor, SHUT_WR);
    std::string answer;
    char buffer[4096];
    for (ssize_t got = 0; (got = ::recv(descriptor, buffer, sizeof buffer, 0)) > 0;) {
      answer.append(buffer, static_cast<std::size_t>(got));
    }
    ::close(descriptor);
    return answer;
  }

  test::ManualClock clock_;
  Lease lease_;
  daemon::PaperBench bench_;
  std::filesystem::path folder_;
  std::filesystem::path socket_;
  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> guard_{io_.get_executor()};
  daemon::LiveHub hub_{[this](std::size_t count) {
    const std::lock_guard lock{mutex_};
    listeners_ = count;
    news_.notify_all();
  }};
  std::mutex mutex_;
  std::condition_variable news_;
  std::size_t listeners_ = 0;
  std::unique_ptr<ControlServer> server_;
  std::thread thread_;
};

TEST_F(ControlServerTest, AnswersOverTheSocketWhichOnlyOwnerAndGroupMayUse) {
  serve();
  struct stat facts {};
  ASSERT_EQ(::stat(socket_.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777U, 0660U);
  const base::Result<daemon::HttpReply> reply =
      client::request(socket_, {"GET", "/v1/status", "", "", ""}, 10s);
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(reply->status, 200);
  EXPECT_EQ(json::parse(reply->body)["scan_count"], 42);
}

constexpr const char* kClose = "\r\nConnection: close\r\n\r\n";

/// No file can be opened as long as it lives.
class NoFilesLeft {
 public:
  NoFilesLeft() {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    const int next = ::dup(0);
    ::close(next);
    const rlimit none{static_cast<rlim_t>(next), before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  NoFilesLeft(const NoFilesLeft&) = delete;
  NoFilesLeft& operator=(const NoFilesLeft&) = delete;
  ~NoFilesLeft() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before_), 0); }

 private:
  rlimit before_{};
};

TEST_F(ControlServerTest, WhereNoFileCanBeOpenedItWaitsInsteadOfTryingWithoutEnd) {
  for (const bool soon : {false, true}) {
    HttpLimits limits;
    limits.accept_again = soon ? 0h : 1h;
    auto server = ControlServer::listen(io_, socket_, make_api(bench_, clock_, lease_), limits);
    ASSERT_TRUE(server) << server.error().message;
    const int client = connected();
    send(client, std::string{"GET /v1/status HTTP/1.1\r\nHost: localhost"} + kClose);
    {
      const NoFilesLeft none;
      int handlers = 0;
      while (handlers < 100 && io_.poll_one() > 0) ++handlers;
      EXPECT_EQ(handlers < 100, !soon);
    }
    std::array<char, 12> answer{};
    ssize_t got = -1;
    while (soon && (got = ::recv(client, answer.data(), answer.size(), MSG_DONTWAIT)) < 0) io_.run_one();
    const std::string begin{answer.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
    EXPECT_EQ(begin, soon ? "HTTP/1.1 200" : "");
    ::close(client);
    server->reset();
    io_.poll();
  }
}

enum class Way { kBySocket, kByTcp };

/// What holds at the socket holds at the TCP port, for whoever has the token.
class EitherListener : public ControlServerTest, public testing::WithParamInterface<Way> {
 protected:
  void open(HttpLimits limits = {}) {
    if (GetParam() == Way::kBySocket) {
      serve(limits);
    } else {
      serve_tcp(limits);
    }
  }
  [[nodiscard]] int client() const { return GetParam() == Way::kBySocket ? connected() : connected_by_tcp(); }
  /// Request line and headers of somebody who may come in, but for the empty line.
  [[nodiscard]] std::string asks(const std::string& method, const std::string& path) const {
    const std::string line = method + " " + path + " HTTP/1.1";
    if (GetParam() == Way::kBySocket) return line;
    return line + "\r\nHost: " + server_->address() + "\r\nAuthorization: Bearer " + kToken;
  }
  [[nodiscard]] std::string answer_to(const std::string& bytes, bool half_close = false) const {
    return raw(client(), bytes, half_close);
  }
  /// A connection that was refused or let go has room again, soon.
  [[nodiscard]] bool is_answered_at_last() const {
    for (const auto end = std::chrono::steady_clock::now() + 60s; std::chrono::steady_clock::now() < end;) {
      if (answer_to(asks("GET", "/v1/status") + kClose).starts_with("HTTP/1.1 200 ")) return true;
    }
    return false;
  }
  /// Sends one byte after the other until the server has had enough.
  static void trickle(int descriptor) {
    for (char buffer[64]; ::send(descriptor, "X", 1, MSG_NOSIGNAL) == 1;) {
      if (::recv(descriptor, buffer, sizeof buffer, MSG_DONTWAIT) == 0) break;
      std::this_thread::yield();
    }
    ::close(descriptor);
  }
};

INSTANTIATE_TEST_SUITE_P(, EitherListener, testing::Values(Way::kBySocket, Way::kByTcp),
                         [](const auto& way) { return way.param == Way::kBySocket ? "Socket" : "Tcp"; });

TEST_P(EitherListener, RefusesWhatIsTooLongOrNoHttp) {
  HttpLimits limits;
  limits.header_size = 256;
  limits.body_size = 16;
  open(limits);
  EXPECT_THAT(answer_to(asks("GET", "/v1/status") + "\r\nX: " + std::string(1000, 'x') + "\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 431 "));
  EXPECT_THAT(answer_to(asks("PUT", "/v1/plan") + "\r\nContent-Length: 17\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to(asks("PUT", "/v1/plan") + "\r\nContent-Length: -1\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 400 "));
  EXPECT_THAT(answer_to("\x01\x02\x03\r\n\r\n"), testing::StartsWith("HTTP/1.1 400 "));
}

TEST_P(EitherListener, LeavesAClientThatSaysNothing) {
  HttpLimits limits;
  limits.time = 20ms;
  open(limits);
  EXPECT_EQ(answer_to("GET /v1/st"), "");
}

TEST_P(EitherListener, AnswersPipelinedRequestsInOrder) {
  open();
  const std::string answer = answer_to(asks("GET", "/v1/status") + "\r\n\r\n" + asks("GET", "/v1/plan") +
                                       "\r\n\r\n" + asks("GET", "/nothing") + kClose);
  const std::size_t status = answer.find("\"scan_count\":42");
  const std::size_t plan = answer.find("\"pull_speed\":null");
  const std::size_t nothing = answer.find("HTTP/1.1 404 ");
  EXPECT_LT(status, plan);
  EXPECT_LT(plan, nothing);
  EXPECT_NE(nothing, std::string::npos);
}

TEST_P(EitherListener, AnswersAClientThatHasClosedItsOwnSide) {
  open();
  EXPECT_THAT(answer_to(asks("GET", "/v1/status") + "\r\n\r\n", true), testing::StartsWith("HTTP/1.1 200 "));
  EXPECT_EQ(answer_to(asks("GET", "/v1/status") + "\r\n", true), "") << "no whole request";
}

// Bytes that trickle do not hold a connection longer than a request may take. There is room for one: while it
// is held nobody else is answered.
TEST_P(EitherListener, LeavesAClientWhoseHeaderTrickles) {
  HttpLimits limits;
  limits.time = 50ms;
  limits.header_size = 1U << 30U;
  limits.connections = 1;
  open(limits);
  const int slow = client();
  send(slow, asks("GET", "/v1/status") + "\r\nX: ");
  trickle(slow);
  EXPECT_TRUE(is_answered_at_last());
}

TEST_P(EitherListener, LeavesAClientWhoseBodyTrickles) {
  HttpLimits limits;
  limits.time = 50ms;
  limits.body_size = 1U << 30U;
  limits.connections = 1;
  open(limits);
  const int slow = client();
  send(slow, asks("PUT", "/v1/plan") + "\r\nContent-Length: 1000000000\r\n\r\n");
  trickle(slow);
  EXPECT_TRUE(is_answered_at_last());
}

// It asks again and again and takes no answer: what the kernel's buffers do not hold waits for it no longer
// than a reply may take to leave.
TEST_P(EitherListener, LeavesAClientThatDoesNotRead) {
  HttpLimits limits;
  limits.time = 50ms;
  limits.connections = 1;
  open(limits);
  const int deaf = client();
  const std::string question = asks("GET", "/v1/openapi.json") + "\r\n\r\n";
  // Blocks when the server reads no more, and fails when it has closed.
  while (::send(deaf, question.data(), question.size(), MSG_NOSIGNAL) > 0) {
  }
  ::close(deaf);
  EXPECT_TRUE(is_answered_at_last());
}

TEST_P(EitherListener, HasRoomForSoManyConnectionsAndNotForOneMore) {
  HttpLimits limits;
  limits.connections = 2;
  open(limits);
  const std::string begun = asks("GET", "/v1/status");
  const int first = client();
  const int second = client();
  // Answered: so they were let in, and they stay.
  for (const int held : {first, second}) {
    send(held, begun + "\r\n\r\n");
    char byte = 0;
    ASSERT_EQ(::recv(held, &byte, 1, MSG_PEEK), 1);
  }
  EXPECT_THAT(answer_to(begun + kClose),
              testing::AllOf(testing::StartsWith("HTTP/1.1 503 "),
                             testing::HasSubstr("2 connections are open, and there is room for no more")));
  ::close(first);
  EXPECT_TRUE(is_answered_at_last());
  ::close(second);
}

// Idle ones, ones that ask for a page, ones that come again and again: none of them has shown a token, and
// whoever has one is answered each time.
TEST_P(EitherListener, WhoHasATokenIsAnsweredWhateverNewcomersDo) {
  HttpLimits limits;
  limits.time = 1h;
  limits.newcomer_time = 1h;  // So that not the time saves it.
  open(limits);
  std::vector<int> idle;
  for (int k = 0; k < 100; ++k) {
    for (const std::string& begun : {std::string{}, std::string{"GET / HT"}}) {
      idle.push_back(client());
      send(idle.back(), begun);
    }
    if (k % 10 == 0) {
      EXPECT_THAT(answer_to(asks("GET", "/v1/status") + kClose), testing::StartsWith("HTTP/1.1 200 ")) << k;
    }
  }
  for (const int one : idle) ::close(one);
}

// However many come and say nothing, no more than so many are kept: the one silent longest goes.
TEST_P(EitherListener, TheNewcomerThatWasSilentLongestMakesRoom) {
  HttpLimits limits;
  limits.time = 1h;
  limits.newcomer_time = 1h;
  limits.newcomers = 2;
  open(limits);
  const int first = client();
  const int second = client();
  const int third = client();
  EXPECT_TRUE(is_let_go(first));
  const std::string begun = asks("GET", "/v1/status");
  for (const int kept : {second, third})
    EXPECT_THAT(raw(kept, begun + kClose), testing::HasSubstr("HTTP/1.1 200 "));
  ::close(first);
}

// Over TCP the page is for anybody, and who reads it stays a newcomer.
TEST_F(ControlServerTest, WhoReadsThePageHasNotBeenSilent) {
  HttpLimits limits;
  limits.time = 1h;
  limits.newcomer_time = 1h;
  limits.newcomers = 2;
  serve_tcp(limits);
  const std::string page = "GET / HTTP/1.1\r\nHost: " + server_->address() + "\r\n\r\n";
  const int first = connected_by_tcp();
  const int second = connected_by_tcp();
  for (const int reader : {second, first}) {
    send(reader, page);
    std::array<char, 4096> part{};
    ASSERT_GT(::recv(reader, part.data(), part.size(), 0), 0);
  }
  const int third = connected_by_tcp();
  EXPECT_TRUE(is_let_go(second));
  for (const int one : {first, second, third}) ::close(one);
}

TEST_P(EitherListener, ANewcomerHasLessTimeThanWhoWasLetIn) {
  HttpLimits limits;
  limits.time = 1h;
  limits.newcomer_time = 20ms;
  open(limits);
  EXPECT_EQ(answer_to(""), "");
  EXPECT_EQ(answer_to(asks("GET", "/v1/status") + "\r\nX: "), "");
  // It stays after its first request, for longer than a newcomer may.
  const int known = client();
  std::array<char, 4096> part{};
  send(known, asks("GET", "/v1/status") + "\r\n\r\n");
  ASSERT_GT(::recv(known, part.data(), part.size(), 0), 0);
  EXPECT_EQ(answer_to(""), "");
  EXPECT_THAT(raw(known, asks("GET", "/v1/status") + kClose), testing::HasSubstr("HTTP/1.1 200 "));
}

TEST_P(EitherListener, AnswersHeadAsGetButForTheBody) {
  open();
  for (const char* path : {"/v1/status", "/nothing", "/v1/live"}) {
    const std::string whole = answer_to(asks("GET", path) + kClose);
    const std::string head = answer_to(asks("HEAD", path) + kClose);
    const std::size_t end = whole.find("\r\n\r\n") + 4;
    EXPECT_EQ(head, whole.substr(0, end)) << path;
    EXPECT_THAT(head, testing::HasSubstr("Content-Length: " + std::to_string(whole.size() - end) + "\r\n"));
  }
  // What follows is told from it.
  const std::string two =
      answer_to(asks("HEAD", "/v1/status") + "\r\n\r\n" + asks("GET", "/v1/plan") + kClose);
  EXPECT_EQ(two.find("HTTP/1.1 200 OK", 1), two.find("\r\n\r\n") + 4) << two;
  EXPECT_THAT(two, testing::HasSubstr("\"pull_speed\":null"));
}

TEST_P(EitherListener, RefusesHeadersThatStandThereTwice) {
  open();
  for (const char* name :
       {"Host", "hOST", "Origin", "Authorization", "Expect", "Stickslip-Controller", "Idempotency-Key"}) {
    const std::string line = std::string{"\r\n"} + name + ": x";
    EXPECT_THAT(answer_to(asks("GET", "/v1/status") + line + line + kClose),
                testing::StartsWith("HTTP/1.1 400 "))
        << name;
  }
}

TEST_P(EitherListener, SaysContinueToWhoWaitsForIt) {
  HttpLimits limits;
  limits.body_size = 16;
  open(limits);
  const std::string put =
      asks("PUT", "/v1/plan") + "\r\nStickslip-Controller: ada\r\nConnection: close\r\nExpect: ";
  const int patient = client();
  send(patient, put + "100-Continue\r\nContent-Length: 2\r\n\r\n");
  std::array<char, 25> interim{};
  ASSERT_EQ(::recv(patient, interim.data(), interim.size(), MSG_WAITALL), 25);
  EXPECT_EQ(std::string(interim.data(), interim.size()), "HTTP/1.1 100 Continue\r\n\r\n");
  EXPECT_THAT(raw(patient, "{}"), testing::StartsWith("HTTP/1.1 200 "));
  // Who cannot be served is told before the body, and so is who waits for something else.
  EXPECT_THAT(answer_to(put + "100-continue\r\nContent-Length: 17\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 413 "));
  EXPECT_THAT(answer_to(put + "200-ok\r\nContent-Length: 2\r\n\r\n"), testing::StartsWith("HTTP/1.1 417 "));
  EXPECT_THAT(raw(client(),
                  "PUT /v1/plan HTTP/1.1\r\nOrigin: x\r\nOrigin: y\r\nExpect: 100-continue\r\n"
                  "Content-Length: 2\r\n\r\n"),
              testing::StartsWith("HTTP/1.1 400 "));
  // Nothing is to come: nothing is waited for.
  EXPECT_THAT(answer_to(asks("GET", "/v1/status") + "\r\nExpect: 100-continue" + kClose),
              testing::StartsWith("HTTP/1.1 200 "));
}

constexpr const char* kUpgrade =
    "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
    "dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";

TEST_P(EitherListener, RefusesMoreListenersThanItHasRoomForAndSaysSo) {
  open();
  const std::string ask =
      asks("GET", "/v1/live") + (GetParam() == Way::kBySocket ? "\r\nHost: x" : "") + kUpgrade;
  std::vector<int> listening;
  for (std::size_t k = 0; k < daemon::LiveHub::kMostClients; ++k) {
    listening.push_back(client());
    send(listening.back(), ask);
  }
  {
    std::unique_lock lock{mutex_};
    news_.wait(lock, [&] { return listeners_ == daemon::LiveHub::kMostClients; });
  }
  EXPECT_THAT(answer_to(ask), testing::AllOf(testing::StartsWith("HTTP/1.1 503 "),
                                             testing::HasSubstr("24 clients read the live stream")));
  EXPECT_THAT(answer_to(asks("GET", "/v1/status") + kClose), testing::StartsWith("HTTP/1.1 200 "));
  for (const int one : listening) ::close(one);
  // Who listens keeps itself until the server has seen it go.
  std::unique_lock lock{mutex_};
  news_.wait(lock, [&] { return listeners_ == 0; });
}

TEST_F(ControlServerTest, AListenerTooManyIsToldWhy) {
  serve();
  std::vector<int> listening;
  for (std::size_t k = 0; k < daemon::LiveHub::kMostClients; ++k) {
    listening.push_back(connected());
    send(listening.back(), std::string{"GET /v1/live HTTP/1.1\r\nHost: x"} + kUpgrade);
  }
  {
    std::unique_lock lock{mutex_};
    news_.wait(lock, [&] { return listeners_ == daemon::LiveHub::kMostClients; });
  }
  const auto refused = client::listen_live(socket_, [](std::string_view) { return true; });
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, testing::HasSubstr("24 clients read the live stream"));
  for (const int one : listening) ::close(one);
  // Who listens keeps itself until the server has seen it go.
  std::unique_lock lock{mutex_};
  news_.wait(lock, [&] { return listeners_ == 0; });
}

TEST_F(ControlServerTest, OverTcpNothingComesWithoutHostAndToken) {
  serve_tcp();
  const std::string own = "\r\nHost: " + server_->address();
  const std::string token = std::string{"\r\nAuthorization: Bearer "} + kToken;
  const auto get = [&](const std::string& path, const std::string& headers) {
    return raw(connected_by_tcp(), "GET " + path + " HTTP/1.1" + headers + kClose);
  };
  EXPECT_THAT(get("/v1/status", own + token), testing::StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(get("/v1/status", own), testing::StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(get("/v1/status", own + token + "x"), testing::StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(get("/v1/status", "\r\nHost: evil" + token), testing::StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(get("/v1/status", own + token + "\r\nOrigin: http://evil"),
              testing::StartsWith("HTTP/1.1 403 "));
  const std::string upgrade =
      "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
      "dGhlIHNhbXBsZSBub25jZQ==";
  EXPECT_THAT(get("/v1/live", own + upgrade), testing::StartsWith("HTTP/1.1 401 "));
  EXPECT_THAT(get("/v1/live", own + token + upgrade + "\r\nOrigin: http://evil"),
              testing::StartsWith("HTTP/1.1 403 "));
  EXPECT_THAT(get("/v1/status", own + token),
              testing::HasSubstr("\r\nContent-Security-Policy: default-src 'none'; "));
}

TEST_F(ControlServerTest, ListensOnThisMachineAlone) {
  for (const char* address : {"0.0.0.0:0", "[::]:0", "192.0.2.1:80", "example.org:80", "127.0.0.1",
                              "127.0.0.1:", "127.0.0.1:x", "127.0.0.1:99999", ""}) {
    const auto server = ControlServer::listen_tcp(io_, address, kToken, make_api(bench_, clock_, lease_));
    ASSERT_FALSE(server) << address;
    EXPECT_EQ(server.error().exit_status(), 2) << address;
  }
}

// Nineteen clients that read, one that does not: the nineteen get every frame, and what the one costs is
// bounded.
TEST_F(ControlServerTest, AStalledClientCostsTheOthersNothing) {
  constexpr int kReaders = 19;
  constexpr int kBatches = 40;
  constexpr int kFrames = 32;  // Below LiveQueue::kMost: whoever reads loses nothing.
  serve();
  const int stalled = connected();
  send(stalled,
       "GET /v1/live HTTP/1.1\r\nHost: x\r\nConnection: Upgrade\r\nUpgrade: "
       "websocket\r\nSec-WebSocket-Version: 13\r\n"
       "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  std::atomic<int> wrong{0};
  std::counting_semaphore<> arrived{0};
  std::vector<std::thread> readers;
  readers.reserve(kReaders);
  for (int k = 0; k < kReaders; ++k) {
    readers.emplace_back([&] {
      int next = 0;
      const auto ended = client::listen_live(socket_, [&](std::string_view frame) {
        if (frame.substr(0, frame.find(' ')) != std::to_string(next)) ++wrong;
        arrived.release();
        return ++next < kBatches * kFrames;
      });
      if (!ended) ++wrong;
    });
  }
  {
    std::unique_lock lock{mutex_};
    news_.wait(lock, [&] { return listeners_ == kReaders + 1; });
  }
  for (int batch = 0; batch < kBatches; ++batch) {
    boost::asio::post(io_, [this, batch] {
      for (int k = 0; k < kFrames; ++k) {
        hub_.publish(std::make_shared<const std::string>(std::to_string(batch * kFrames + k) +
                                                         std::string(4000, ' ')));
      }
    });
    for (int k = 0; k < kReaders * kFrames; ++k) arrived.acquire();
  }
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(wrong, 0);
  std::promise<std::uint64_t> dropped;
  boost::asio::post(io_, [&] { dropped.set_value(hub_.dropped_count()); });
  const std::uint64_t count = dropped.get_future().get();
  // 5 MB were meant for it; the kernel keeps what its buffers hold, the queue 64 frames, the rest is dropped.
  EXPECT_GT(count, 500U);
  EXPECT_LT(count, static_cast<std::uint64_t>(kBatches * kFrames));
  ::close(stalled);
  std::unique_lock lock{mutex_};
  news_.wait(lock, [&] { return listeners_ == 0; });
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
  const auto second = ControlServer::listen(io_, socket_, make_api(bench_, clock_, lease_));
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, testing::HasSubstr("another process is listening"));

  std::ofstream{folder_ / "file"} << "x";
  const auto file = ControlServer::listen(io_, folder_ / "file", make_api(bench_, clock_, lease_));
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().exit_status(), 2);
  const auto longest =
      ControlServer::listen(io_, folder_ / std::string(200, 'x'), make_api(bench_, clock_, lease_));
  ASSERT_FALSE(longest);
  EXPECT_EQ(longest.error().exit_status(), 2);
}

// Somebody removed the socket file, and another daemon listens at the same path.
TEST_F(ControlServerTest, LeavesTheSocketOfAnotherWhenItStops) {
  serve();
  std::filesystem::remove(socket_);
  auto other = ControlServer::listen(io_, socket_, make_api(bench_, clock_, lease_));
  ASSERT_TRUE(other) << other.error().message;
  std::promise<void> stopped;
  boost::asio::post(io_, [&] {
    server_.reset();
    stopped.set_value();
  });
  stopped.get_future().wait();
  const auto reply = client::request(socket_, {"GET", "/v1/status", "", "", ""}, 10s);
  ASSERT_TRUE(reply) << reply.error().message;
  EXPECT_EQ(reply->status, 200);
  std::promise<void> taken;
  boost::asio::post(io_, [&] {
    server_ = *std::move(other);
    taken.set_value();
  });
  taken.get_future().wait();
}

// One that does not come to answering is no left-over.
TEST_F(ControlServerTest, TakesTheSocketOfNobodyWhoIsBusy) {
  const int busy = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket_.string().copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(busy, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(busy, 0), 0);
  const int waiting = connected();
  const auto second = ControlServer::listen(io_, socket_, make_api(bench_, clock_, lease_));
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, testing::HasSubstr("choose another path in [control] socket"));
  EXPECT_TRUE(std::filesystem::exists(socket_));
  ::close(waiting);
  ::close(busy);
}

TEST(ControlClient, SaysThatNobodyAnswers) {
  const base::Result<daemon::HttpReply> reply =
      client::request("/nonexistent/s", {"GET", "/", "", "", ""}, 1s);
  ASSERT_FALSE(reply);
  EXPECT_THAT(reply.error().message, testing::HasSubstr("is stickslipd running"));
}

}  // namespace
}  // namespace stickslip::control
