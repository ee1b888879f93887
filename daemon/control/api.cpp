#include "daemon/control/api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "daemon/batch/batch_json.hpp"
#include "daemon/control/batch_api.hpp"
#include "daemon/control/calibration_api.hpp"
#include "daemon/control/calibration_json.hpp"
#include "daemon/control/lease.hpp"
#include "daemon/control/metrics.hpp"
#include "daemon/control/openapi.hpp"
#include "daemon/control/plan_json.hpp"
#include "daemon/control/record_request.hpp"
#include "daemon/control/repeats.hpp"
#include "daemon/control/reply.hpp"
#include "daemon/control/report_api.hpp"
#include "daemon/control/request_body.hpp"
#include "daemon/control/summary.hpp"
#include "daemon/json_text.hpp"

namespace stickslip::daemon {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestController = 64;

class Api {
 public:
  Api(Bench& bench, const base::Clock& clock) : bench_(bench), batches_(bench.batches()), clock_(clock) {}

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
  static const std::array<Route, 30> kRoutes;

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
    if (const std::string why = base::name_refusal(request.controller, kLongestController); !why.empty()) {
      answer(refusal(400, "Stickslip-Controller: " + why));
      return;
    }
    const std::string& key = request.idempotency_key;
    if (key.size() > Repeats::kLongestKey) {
      answer(refusal(400, fmt::format("Idempotency-Key: is longer than {} bytes", Repeats::kLongestKey)));
      return;
    }
    if (!key.empty()) {
      switch (repeats_.look(request, now_ns())) {
        case Repeats::Found::kAnswered:
          answer(repeats_.answer(request));
          return;
        case Repeats::Found::kWaiting:
          answer(refusal(409, "the request with this Idempotency-Key is still being answered"));
          return;
        case Repeats::Found::kOther:
          answer(refusal(422, "this Idempotency-Key was used for another request"));
          return;
        case Repeats::Found::kTooManyClients:
          answer(refusal(
              503,
              fmt::format("{} clients have sent an Idempotency-Key in the last {} min, and more are not "
                          "remembered: use a name that was used before, or send the request without a key",
                          Repeats::kMostClients, Repeats::kRemembered.count())));
          return;
        case Repeats::Found::kNew:
          answer = [this, request, answer = std::move(answer)](const HttpReply& reply) {
            repeats_.answered(request, reply);
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

  [[nodiscard]] Json described(const TestSummary& test, const BatchBook& book, bool with_details) const {
    Json json = test_json(test, with_details);
    json["voided"] = voiding_json(test.file.empty() ? nullptr : book.voided(batches_.name_of(test.file)));
    return json;
  }

  void tests(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    Json list = Json::array();
    const BatchBook& book = batches_.book();
    const std::vector<TestSummary> tests = bench_.tests();
    for (const TestSummary& test : tests) list.push_back(described(test, book, false));
    Json summary =
        summary_json(tests, book, [this](const std::string& file) { return batches_.name_of(file); });
    answer(reply_of({{"tests", std::move(list)}, {"summary", std::move(summary)}}));
  }

  void test(const HttpRequest&, const std::string& rest, const HttpAnswer& answer) {
    std::int64_t number = 0;
    const char* const end = rest.data() + rest.size();
    const auto [stopped, error] = std::from_chars(rest.data(), end, number);
    if (error == std::errc{} && stopped == end) {
      for (const TestSummary& test : bench_.tests()) {
        if (test.number != number) continue;
        answer(reply_of(described(test, batches_.book(), true)));
        return;
      }
    }
    answer(refusal(404, fmt::format("there is no test {} among the latest {}; GET /v1/tests lists them",
                                    printable(rest), TestLog::kMaxTests)));
  }

  void record(const HttpRequest&, const std::string& rest, const HttpAnswer& answer) {
    answer(record_reply(rest, bench_.tests()));
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
    if (const auto progress = batches_.progress(); progress && progress->next) {
      return answer(refusal(409, fmt::format("batch {} ({}) plans the tests; DELETE /v1/batch ends it",
                                             progress->id, progress->name)));
    }
    if (!take(request, Lease::kCommand_s, answer)) return;
    bench_.set_plan(*std::move(plan));
    answer(reply_of(plan_json(bench_.plan())));
  }

  void batch(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer(reply_of(batch_json(batches_)));
  }

  void begin_batch(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    const auto body = object_of(request.body, {});
    if (!body) return answer(refusal(400, body.error().message));
    base::Result<BatchPlan> plan = batch_plan_of(*body);
    if (!plan) return answer(refusal(400, plan.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.begin(*std::move(plan), request.controller, reply_with_batch(batches_, answer));
  }

  void end_batch(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.end(request.controller, reply_with_batch(batches_, answer));
  }

  void void_test(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    const auto body = object_of(request.body, {"test", "record", "reason"});
    if (!body) return answer(refusal(400, body.error().message));
    const Json reason = body->value("reason", Json());
    if (!reason.is_string() || reason.get<std::string>().empty())
      return answer(refusal(400, "reason: is missing: why does the test not count?"));
    if (const std::string why = base::name_refusal(reason.get<std::string>()); !why.empty())
      return answer(refusal(400, "reason: " + why));
    const base::Result<std::string> record = record_named(*body, bench_, batches_);
    if (!record) return answer(refusal(400, record.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.void_test(*record, reason.get<std::string>(), request.controller,
                       reply_with_batch(batches_, answer));
  }

  void restore_test(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    const auto body = object_of(request.body, {"test", "record"});
    if (!body) return answer(refusal(400, body.error().message));
    const base::Result<std::string> record = record_named(*body, bench_, batches_);
    if (!record) return answer(refusal(400, record.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.restore(*record, request.controller, reply_with_batch(batches_, answer));
  }

  void batches(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer(reply_of(batches_json(batches_.book())));
  }
  void report(const HttpRequest& request, const std::string& rest, const HttpAnswer& answer) {
    answer_report(request, rest, batches_.book(), bench_.reports(), answer);
  }
  void compare(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    answer_comparison(request, batches_.book(), bench_.reports(), answer);
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
      if (const std::string why = base::name_refusal(command.text); !why.empty())
        return answer(refusal(400, "text: " + why));
    }
    if (!take(request, Lease::kCommand_s, answer)) return;
    bench_.command(std::move(command), [kind, answer](const Outcome& outcome) {
      const pipeline::TareReport& report = outcome.report;
      if (!report.refusal.empty()) {
        answer({409, json_text({{"error", report.refusal}, {"bench", pipeline::name(report.state)}}), {}});
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

  // The load cell's calibration.

  void calibration(const HttpRequest&, const std::string&, const HttpAnswer& answer) {
    answer(reply_of(calibration_json(bench_.calibrator().view())));
  }
  void calibrate(const HttpRequest& request, const std::string&, const HttpAnswer& answer) {
    const base::Result<CalibrationStep> step = calibration_step(request);
    if (!step) return answer(refusal(400, step.error().message));
    if (!take(request, Lease::kCalibration_s, answer)) return;
    Calibrator& calibrator = bench_.calibrator();
    (*step)(calibrator, [&calibrator, answer](const std::string& why_not) {
      answer(why_not.empty() ? reply_of(calibration_json(calibrator.view())) : refusal(409, why_not));
    });
  }

  Bench& bench_;
  Batches& batches_;
  const base::Clock& clock_;
  Lease lease_;
  Repeats repeats_;
};

const std::array<Api::Route, 30> Api::kRoutes{{
    {"GET", "/v1/status", false, &Api::status},
    {"GET", "/v1/openapi.json", false, &Api::description},
    {"GET", "/v1/tests", false, &Api::tests},
    {"GET", "/v1/tests/", false, &Api::test},
    {"GET", "/v1/records/", false, &Api::record},
    {"GET", "/v1/plan", false, &Api::plan},
    {"PUT", "/v1/plan", true, &Api::set_plan},
    {"GET", "/v1/batch", false, &Api::batch},
    {"POST", "/v1/batch", true, &Api::begin_batch},
    {"DELETE", "/v1/batch", true, &Api::end_batch},
    {"GET", "/v1/batches", false, &Api::batches},
    {"GET", "/v1/batches/", false, &Api::report},
    {"GET", "/v1/compare", false, &Api::compare},
    {"POST", "/v1/void", true, &Api::void_test},
    {"POST", "/v1/restore", true, &Api::restore_test},
    {"GET", "/v1/controller", false, &Api::controller},
    {"PUT", "/v1/controller", true, &Api::take_control},
    {"DELETE", "/v1/controller", true, &Api::release_control},
    {"POST", "/v1/arm", true, &Api::arm},
    {"POST", "/v1/start", true, &Api::start},
    {"POST", "/v1/stop", true, &Api::stop},
    {"POST", "/v1/mark", true, &Api::mark},
    {"POST", "/v1/tare", true, &Api::tare},
    {"GET", "/v1/calibration", false, &Api::calibration},
    {"POST", "/v1/calibration", true, &Api::calibrate},
    {"DELETE", "/v1/calibration", true, &Api::calibrate},
    {"POST", "/v1/calibration/weight", true, &Api::calibrate},
    {"POST", "/v1/calibration/undo", true, &Api::calibrate},
    {"POST", "/v1/calibration/finish", true, &Api::calibrate},
    {"GET", "/metrics", false, &Api::metrics},
}};

}  // namespace

HttpHandler make_api(Bench& bench, const base::Clock& clock) {
  auto api = std::make_shared<Api>(bench, clock);
  return [api](const HttpRequest& request, HttpAnswer answer) { api->handle(request, std::move(answer)); };
}

}  // namespace stickslip::daemon
