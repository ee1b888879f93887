#include "daemon/control/api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/control/lease.hpp"
#include "daemon/control/metrics.hpp"
#include "daemon/control/openapi.hpp"
#include "daemon/control/plan_json.hpp"
#include "daemon/control/repeats.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestName = 64;

/// Names of files and boards come from outside: bytes that are no UTF-8 are replaced.
std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

HttpReply reply_of(const Json& json) { return {200, text_of(json), {}}; }

HttpReply refusal(int status, const std::string& why, std::string allow = {}) {
  return {status, text_of({{"error", why}}), std::move(allow)};
}

/// A request line may hold any bytes; an answer may not.
std::string printable(const std::string& text) {
  constexpr std::size_t kLongest = 100;
  std::string shown;
  for (const char c : text.substr(0, kLongest)) shown += c >= 0x20 && c < 0x7F ? c : '?';
  return shown;
}

/// The JSON object of a body, with no keys but these; an empty body is an empty object.
base::Result<Json> object_of(const std::string& body, std::initializer_list<std::string_view> keys) {
  if (body.empty()) return Json::object();
  Json json = Json::parse(body, nullptr, false);
  if (!json.is_object()) return base::usage_error("the body must be a JSON object");
  for (const auto& [key, value] : json.items()) {
    if (keys.size() > 0 && std::find(keys.begin(), keys.end(), key) == keys.end()) {
      return base::usage_error("\"{}\": there is no such key; there is {}", printable(key),
                               fmt::join(keys, ", "));
    }
  }
  return json;
}

class Api {
 public:
  Api(Bench& bench, const base::Clock& clock) : bench_(bench), clock_(clock) {}

  void handle(const HttpRequest& request, HttpAnswer answer) {
    const std::string path = request.target.substr(0, request.target.find('?'));
    std::string allowed;
    for (const Route& route : kRoutes) {
      const std::optional<std::string> rest = match(route, path);
      if (!rest) continue;
      if (route.method == request.method) {
        dispatch(route, request, *rest, std::move(answer));
        return;
      }
      allowed += fmt::format("{}{}", allowed.empty() ? "" : ", ", route.method);
    }
    if (allowed.empty()) {
      answer(refusal(
          404, fmt::format("there is nothing at {}; /v1/openapi.json says what there is", printable(path))));
    } else {
      answer(refusal(405,
                     fmt::format("{} is not allowed at {}; {} is", printable(request.method), path, allowed),
                     allowed));
    }
  }

 private:
  using Function = void (Api::*)(const HttpRequest&, const std::string& rest, const HttpAnswer&);
  struct Route {
    std::string_view method;
    std::string_view path;  ///< A slash at its end: and one part more, the rest.
    bool changes;
    Function function;
  };
  static const std::array<Route, 15> kRoutes;

  static std::optional<std::string> match(const Route& route, const std::string& path) {
    if (!route.path.ends_with('/')) return path == route.path ? std::optional<std::string>{""} : std::nullopt;
    if (!path.starts_with(route.path) || path.size() == route.path.size()) return std::nullopt;
    return path.substr(route.path.size());
  }

  /// Names and repetitions first, for what changes something.
  void dispatch(const Route& route, const HttpRequest& request, const std::string& rest, HttpAnswer answer) {
    if (!route.changes) {
      (this->*route.function)(request, rest, answer);
      return;
    }
    if (request.controller.empty()) {
      answer(refusal(400, "who commands? Give a name in the header Stickslip-Controller"));
      return;
    }
    std::string why = text_refusal(request.controller);
    if (request.controller.size() > kLongestName) why = fmt::format("is longer than {} bytes", kLongestName);
    if (!why.empty()) {
      answer(refusal(400, "Stickslip-Controller: " + why));
      return;
    }
    const std::string& key = request.idempotency_key;
    if (key.size() > Repeats::kLongestKey) {
      answer(refusal(400, fmt::format("Idempotency-Key: is longer than {} bytes", Repeats::kLongestKey)));
      return;
    }
    if (!key.empty()) {
      switch (repeats_.look(request)) {
        case Repeats::Found::kAnswered:
          answer(repeats_.answer(key));
          return;
        case Repeats::Found::kWaiting:
          answer(refusal(409, "the request with this Idempotency-Key is still being answered"));
          return;
        case Repeats::Found::kOther:
          answer(refusal(422, "this Idempotency-Key was used for another request"));
          return;
        case Repeats::Found::kNew:
          answer = [this, key, answer = std::move(answer)](const HttpReply& reply) {
            repeats_.answered(key, reply);
            answer(reply);
          };
          break;
      }
    }
    (this->*route.function)(request, rest, answer);
  }

  [[nodiscard]] std::int64_t now_ns() const { return clock_.monotonic_ns(); }

  /// The bench for this client. \return false after a refusal.
  bool take(const HttpRequest& request, double for_s, const HttpAnswer& answer) {
    const auto holder = lease_.take(request.controller, for_s, now_ns());
    if (!holder) return true;
    answer(refusal(409,
                   fmt::format("{} has the bench for another {:.0f} s; one at a time commands, all may read",
                               *holder, std::max(1.0, lease_.left_s(now_ns())))));
    return false;
  }

  // Readers.

  void status(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer(reply_of(status_json(bench_.status())));
  }

  void metrics(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    HttpReply reply{200, metrics_text(bench_.status()), {}};
    reply.content_type = kMetricsType;
    answer(std::move(reply));
  }

  void description(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer({200, std::string{openapi()}, {}});
  }

  void tests(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    Json list = Json::array();
    for (const TestSummary& test : bench_.tests()) list.push_back(test_json(test, false));
    answer(reply_of({{"tests", std::move(list)}}));
  }

  void test(const HttpRequest&, const std::string& rest, const HttpAnswer& answer) {
    std::int64_t number = 0;
    const char* const end = rest.data() + rest.size();
    const auto [stopped, error] = std::from_chars(rest.data(), end, number);
    if (error == std::errc{} && stopped == end) {
      for (const TestSummary& test : bench_.tests()) {
        if (test.number != number) continue;
        answer(reply_of(test_json(test, true)));
        return;
      }
    }
    answer(refusal(404, fmt::format("there is no test {} among the latest {}; GET /v1/tests lists them",
                                    printable(rest), TestLog::kMaxTests)));
  }

  void plan(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer(reply_of(plan_json(bench_.plan())));
  }

  void controller(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer(reply_of(lease_json()));
  }

  [[nodiscard]] Json lease_json() const {
    const auto holder = lease_.holder(now_ns());
    return {{"controller", holder ? Json(*holder) : Json(nullptr)},
            {"seconds_left", lease_.left_s(now_ns())}};
  }

  // Who commands.

  void take_control(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    const auto body = object_of(request.body, {"seconds"});
    if (!body) return answer(refusal(400, body.error().message));
    const Json seconds = body->value("seconds", Json(Lease::kCommand_s));
    if (!seconds.is_number() || !(seconds > 0.0) || !(seconds <= Lease::kLongest_s)) {
      return answer(
          refusal(400, fmt::format("seconds: must be a number above 0 and at most {}", Lease::kLongest_s)));
    }
    if (take(request, seconds.get<double>(), answer)) answer(reply_of(lease_json()));
  }

  void release_control(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    if (lease_.release(request.controller, now_ns())) return answer(reply_of(lease_json()));
    answer(refusal(409, fmt::format("{} has the bench", *lease_.holder(now_ns()))));
  }

  void set_plan(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    const auto body = object_of(request.body, {});
    if (!body) return answer(refusal(400, body.error().message));
    base::Result<Plan> plan = plan_of(*body);
    if (!plan) return answer(refusal(400, plan.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    bench_.set_plan(*std::move(plan));
    answer(reply_of(plan_json(bench_.plan())));
  }

  void arm(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    command(Command::Kind::kArm, request, {}, answer);
  }
  void start(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    command(Command::Kind::kStart, request, "test", answer);
  }
  void stop(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    command(Command::Kind::kStop, request, "test", answer);
  }
  void mark(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    command(Command::Kind::kMark, request, "text", answer);
  }
  void tare(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    command(Command::Kind::kTare, request, {}, answer);
  }

  /// \param key  that its body may have; empty: none.
  void command(Command::Kind kind, const HttpRequest& request, std::string_view key,
               const HttpAnswer& answer) {
    const auto body = object_of(request.body, {key});
    if (!body) return answer(refusal(400, body.error().message));
    Command command{kind, request.controller, {}, {}};
    if (body->contains("test")) {
      const Json& test = body->at("test");
      if (!test.is_number_integer() || test < 1)
        return answer(refusal(400, "test: must be a whole number from 1 on"));
      command.test = test.get<std::int64_t>();
    }
    if (kind == Command::Kind::kMark) {
      const Json text = body->value("text", Json());
      if (!text.is_string() || text.get<std::string>().empty())
        return answer(refusal(400, "text: is missing: what is to be noted?"));
      command.text = text.get<std::string>();
      if (const std::string why = text_refusal(command.text); !why.empty())
        return answer(refusal(400, "text: " + why));
    }
    if (!take(request, Lease::kCommand_s, answer)) return;
    bench_.command(std::move(command), [kind, answer](const Outcome& outcome) {
      const pipeline::TareReport& report = outcome.report;
      if (!report.refusal.empty()) {
        answer({409, text_of({{"error", report.refusal}, {"bench", pipeline::name(report.state)}}), {}});
        return;
      }
      Json json{{"bench", pipeline::name(report.state)},
                {"test", report.test},
                {"scan", report.scan},
                {"already", outcome.already}};
      if (kind == Command::Kind::kTare) {
        json["zero"] = report.zero_V;
        json["zero_standard_error"] = report.zero_standard_error_V;
        json["moved_force"] = report.moved_N;
        json["scan_count"] = report.scan_count;
      }
      answer(reply_of(json));
    });
  }

  Bench& bench_;
  const base::Clock& clock_;
  Lease lease_;
  Repeats repeats_;
};

const std::array<Api::Route, 15> Api::kRoutes{{
    {"GET", "/v1/status", false, &Api::status},
    {"GET", "/v1/openapi.json", false, &Api::description},
    {"GET", "/v1/tests", false, &Api::tests},
    {"GET", "/v1/tests/", false, &Api::test},
    {"GET", "/v1/plan", false, &Api::plan},
    {"PUT", "/v1/plan", true, &Api::set_plan},
    {"GET", "/v1/controller", false, &Api::controller},
    {"PUT", "/v1/controller", true, &Api::take_control},
    {"DELETE", "/v1/controller", true, &Api::release_control},
    {"POST", "/v1/arm", true, &Api::arm},
    {"POST", "/v1/start", true, &Api::start},
    {"POST", "/v1/stop", true, &Api::stop},
    {"POST", "/v1/mark", true, &Api::mark},
    {"POST", "/v1/tare", true, &Api::tare},
    {"GET", "/metrics", false, &Api::metrics},
}};

}  // namespace

HttpHandler make_api(Bench& bench, const base::Clock& clock) {
  auto api = std::make_shared<Api>(bench, clock);
  return [api](const HttpRequest& request, HttpAnswer answer) { api->handle(request, std::move(answer)); };
}

}  // namespace stickslip::daemon
