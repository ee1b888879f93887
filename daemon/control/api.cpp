#include "daemon/control/api.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <utility>

#include "io/json_text.hpp"
#include <nlohmann/json.hpp>

#include "core/base/text.hpp"
#include "daemon/control/batch_api.hpp"
#include "daemon/control/calibration_api.hpp"
#include "daemon/control/metrics.hpp"
#include "daemon/control/openapi.hpp"
#include "daemon/control/records_api.hpp"
#include "daemon/control/repeats.hpp"
#include "daemon/control/report_api.hpp"
#include "daemon/control/request_body.hpp"
#include "daemon/control/summary.hpp"
#include "daemon/control/trace_api.hpp"
#include "daemon/types/batch_json.hpp"
#include "daemon/types/calibration_json.hpp"
#include "daemon/types/plan_json.hpp"
#include "daemon/types/reply.hpp"

namespace stickslip::control {
namespace {

using Json = nlohmann::ordered_json;

/// Longest name of a controller.
constexpr std::size_t kLongestController = 64;

/// Why there is no test of that number, and which there are.
std::string no_such_test(const std::string& number, const std::vector<daemon::TestSummary>& tests) {
  if (tests.empty()) return fmt::format("there is no test {}: none has been measured yet", number);
  const auto [first, last] = std::minmax_element(
      tests.begin(), tests.end(), [](const daemon::TestSummary& one, const daemon::TestSummary& other) {
        return one.number < other.number;
      });
  return fmt::format(
      "there is no test {}: of the latest {} there are {} to {} (stickslip list, GET /v1/tests); an earlier "
      "one is "
      "named by its file, stickslip show FILE.h5",
      number, tests.size(), first->number, last->number);
}

class Api {
 public:
  Api(daemon::Bench& bench, const base::Clock& clock, Lease& lease)
      : bench_(bench), batches_(bench.batches()), clock_(clock), lease_(lease) {}

  void handle(const daemon::HttpRequest& request, daemon::HttpAnswer answer) {
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
      answer(daemon::refusal(
          404, fmt::format("there is nothing at {}; /v1/openapi.json says what there is", printable(path))));
    } else {
      answer(daemon::refusal(
          405, fmt::format("{} is not allowed at {}; {} is", printable(request.method), path, allowed),
          allowed));
    }
  }

 private:
  using Function = void (Api::*)(const daemon::HttpRequest&, const std::string& rest,
                                 const daemon::HttpAnswer&);
  struct Route {
    std::string_view method;
    std::string_view path;  ///< A path that ends in a slash takes one more part, `rest`.
    bool changes;
    Function function;
  };
  static const std::array<Route, 32> kRoutes;

  static std::optional<std::string> match(const Route& route, const std::string& path) {
    if (!route.path.ends_with('/')) return path == route.path ? std::optional<std::string>{""} : std::nullopt;
    if (!path.starts_with(route.path) || path.size() == route.path.size()) return std::nullopt;
    return path.substr(route.path.size());
  }

  /// Calls the function of a route. If the route changes something, checks name and Idempotency-Key first.
  void dispatch(const Route& route, const daemon::HttpRequest& request, const std::string& rest,
                daemon::HttpAnswer answer) {
    if (!route.changes) {
      (this->*route.function)(request, rest, answer);
      return;
    }
    if (request.controller.empty()) {
      answer(daemon::refusal(400, "who commands? Give a name in the header Stickslip-Controller"));
      return;
    }
    if (const std::string why = base::name_refusal(request.controller, kLongestController); !why.empty()) {
      answer(daemon::refusal(400, "Stickslip-Controller: " + why));
      return;
    }
    const std::string& key = request.idempotency_key;
    if (key.size() > Repeats::kLongestKey) {
      answer(daemon::refusal(400,
                             fmt::format("Idempotency-Key: is longer than {} bytes", Repeats::kLongestKey)));
      return;
    }
    if (!key.empty()) {
      switch (repeats_.look(request, now_ns())) {
        case Repeats::Found::kAnswered:
          answer(repeats_.answer(request));
          return;
        case Repeats::Found::kWaiting:
          answer(daemon::refusal(409, "the request with this Idempotency-Key is still being answered"));
          return;
        case Repeats::Found::kOther:
          answer(daemon::refusal(422, "this Idempotency-Key was used for another request"));
          return;
        case Repeats::Found::kTooManyClients:
          answer(daemon::refusal(
              503,
              fmt::format("{} clients have sent an Idempotency-Key in the last {} min, and more are not "
                          "remembered: use a name that was used before, or send the request without a key",
                          Repeats::kMostClients, Repeats::kRemembered.count())));
          return;
        case Repeats::Found::kNew:
          answer = [this, request, answer = std::move(answer)](const daemon::HttpReply& reply) {
            repeats_.answered(request, reply);
            answer(reply);
          };
          break;
      }
    }
    (this->*route.function)(request, rest, answer);
  }

  [[nodiscard]] std::int64_t now_ns() const { return clock_.monotonic_ns(); }

  /// Takes the lease of the bench for this client. \return false if it was refused; then `answer` was called.
  bool take(const daemon::HttpRequest& request, double for_s, const daemon::HttpAnswer& answer) {
    const auto holder = lease_.take(request.controller, for_s, now_ns());
    if (!holder) return true;
    answer(held_by(*holder));
    return false;
  }
  [[nodiscard]] daemon::HttpReply held_by(const std::string& holder) const {
    return daemon::refusal(
        409, fmt::format("{} has the bench for another {:.0f} s; one at a time commands, all may read. Take "
                         "it over with \"Take it over …\" of the live page, or PUT /v1/controller {}",
                         holder, std::max(1.0, lease_.state(now_ns()).seconds_left),
                         Json{{"from", holder}}.dump()));
  }

  // Readers.

  void status(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer(daemon::reply_of(daemon::status_json(bench_.status())));
  }

  void metrics(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    daemon::HttpReply reply{200, metrics_text(bench_.status()), {}};
    reply.content_type = kMetricsType;
    answer(std::move(reply));
  }

  void description(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer({200, std::string{openapi()}, {}});
  }

  [[nodiscard]] Json described(const daemon::TestSummary& test, bool with_details) const {
    Json json = daemon::test_json(test, with_details);
    json["voided"] = daemon::voiding_json(voided(test));
    return json;
  }

  /// Null: the test counts.
  [[nodiscard]] const daemon::Voiding* voided(const daemon::TestSummary& test) const {
    return test.file.empty() ? nullptr : batches_.book().voided(batches_.name_of(test.file));
  }

  void tests(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    Json list = Json::array();
    const daemon::BatchBook& book = batches_.book();
    const std::vector<daemon::TestSummary> tests = bench_.tests();
    for (const daemon::TestSummary& test : tests) list.push_back(described(test, false));
    Json summary =
        summary_json(tests, book, [this](const std::string& file) { return batches_.name_of(file); });
    answer(daemon::reply_of({{"tests", std::move(list)}, {"summary", std::move(summary)}}));
  }

  /// \param rest  "N" or "N/trace".
  void test(const daemon::HttpRequest& request, const std::string& rest, const daemon::HttpAnswer& answer) {
    const bool trace = rest.ends_with(kTracePath);
    const std::string named = trace ? rest.substr(0, rest.size() - kTracePath.size()) : rest;
    const std::vector<daemon::TestSummary> tests = bench_.tests();
    std::int64_t number = 0;
    const char* const end = named.data() + named.size();
    const auto [stopped, error] = std::from_chars(named.data(), end, number);
    if (error == std::errc{} && stopped == end) {
      for (const daemon::TestSummary& test : tests) {
        if (test.number != number) continue;
        if (trace)
          return answer_trace(request, test.file, without_trace(test, voided(test)), bench_.reports(),
                              answer);
        return answer(daemon::reply_of(described(test, true)));
      }
      if (trace && bench_.status().current_test == number)
        return answer(daemon::refusal(
            409, fmt::format("test {} is running; GET /v1/live tells its scans until it has ended", number)));
    }
    answer(daemon::refusal(404, no_such_test(printable(named), tests)));
  }

  void trend(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    bench_.trend([answer](std::string text) { answer({200, std::move(text), {}}); });
  }

  void records(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    answer_search(request, bench_.reports(), answer);
  }
  void record(const daemon::HttpRequest& request, const std::string& rest, const daemon::HttpAnswer& answer) {
    answer_record(request, rest, bench_, answer);
  }

  void plan(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer(daemon::reply_of(daemon::plan_json(bench_.plan())));
  }

  void controller(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer(daemon::reply_of(lease_json()));
  }

  [[nodiscard]] Json lease_json() const { return daemon::lease_json(lease_.state(now_ns())); }

  // Commands.

  /// The answer with the warnings of its request.
  [[nodiscard]] static daemon::HttpAnswer warned(daemon::HttpAnswer answer,
                                                 const daemon::Warnings& warnings) {
    if (warnings.empty()) return answer;
    return [answer = std::move(answer), text = daemon::text_of(warnings)](daemon::HttpReply reply) {
      reply.warning = text;
      answer(std::move(reply));
    };
  }

  void take_control(const daemon::HttpRequest& request, const std::string&,
                    const daemon::HttpAnswer& answer) {
    const auto body = object_of(request.body, {"seconds", "from"});
    if (!body) return answer(daemon::refusal(400, body.error().message));
    const Json from = body->value("from", Json(request.controller));
    if (!from.is_string())
      return answer(
          daemon::refusal(400, "from: must be the name of who has the bench, as GET /v1/controller"));
    const Json seconds = body->value("seconds", Json(Lease::kCommand_s));
    if (!seconds.is_number() || !(seconds > 0.0) || !(seconds <= Lease::kLongest_s)) {
      return answer(daemon::refusal(
          400, fmt::format("seconds: must be a number above 0 and at most {}", Lease::kLongest_s)));
    }
    const auto holder =
        lease_.take_over(request.controller, from.get<std::string>(), seconds.get<double>(), now_ns());
    if (holder) return answer(held_by(*holder));
    answer(daemon::reply_of(lease_json()));
  }

  void release_control(const daemon::HttpRequest& request, const std::string&,
                       const daemon::HttpAnswer& answer) {
    const auto now = now_ns();
    if (lease_.release(request.controller, now)) return answer(daemon::reply_of(lease_json()));
    answer(held_by(*lease_.holder(now)));
  }

  /// While a batch plans the tests, only facts that it does not state may change. Makes `plan` that of the
  /// next test with these facts. \return why not; empty: it may be set.
  [[nodiscard]] std::string why_batch_refuses(daemon::Plan& plan) {
    const auto progress = batches_.progress();
    if (!progress || !progress->next) return {};
    daemon::Plan next = bench_.plan();
    next.sample.metadata = plan.sample.metadata;
    plan.sample.replicate = next.sample.replicate;  // It rises as tests begin.
    const record::Metadata& stated = batches_.book().current()->plan.sample.metadata;
    const bool may = daemon::plan_json(next) == daemon::plan_json(plan) &&
                     record::merged(plan.sample.metadata, stated) == plan.sample.metadata;
    plan = std::move(next);
    return may ? std::string{}
               : fmt::format(
                     "batch {} ({}) states all but some facts of its tests: end it first (stickslip batch "
                     "end, "
                     "DELETE /v1/batch)",
                     progress->id, progress->name);
  }

  void set_plan(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    const auto body = object_of(request.body, {});
    if (!body) return answer(daemon::refusal(400, body.error().message));
    daemon::Warnings warnings;
    base::Result<daemon::Plan> plan = daemon::plan_of(*body, &warnings);
    if (!plan) return answer(daemon::refusal(400, plan.error().message));
    if (!body->contains("facts")) plan->sample.metadata = bench_.plan().sample.metadata;
    if (const std::string why = why_batch_refuses(*plan); !why.empty())
      return answer(daemon::refusal(409, why));
    if (!take(request, Lease::kCommand_s, answer)) return;
    bench_.set_plan(*std::move(plan));
    warned(answer, warnings)(daemon::reply_of(daemon::plan_json(bench_.plan())));
  }

  void batch(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer(daemon::reply_of(batch_json(batches_)));
  }

  void begin_batch(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    const auto body = object_of(request.body, {});
    if (!body) return answer(daemon::refusal(400, body.error().message));
    daemon::Warnings warnings;
    base::Result<daemon::BatchPlan> plan = daemon::batch_plan_of(*body, &warnings);
    if (!plan) return answer(daemon::refusal(400, plan.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.begin(*std::move(plan), request.controller,
                   reply_with_batch(batches_, warned(answer, warnings)));
  }

  void end_batch(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.end(request.controller, reply_with_batch(batches_, answer));
  }

  void void_test(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    const auto body = object_of(request.body, {"test", "record", "reason"});
    if (!body) return answer(daemon::refusal(400, body.error().message));
    const Json reason = body->value("reason", Json());
    if (!reason.is_string() || reason.get<std::string>().empty())
      return answer(daemon::refusal(400, "reason: is missing: why does the test not count?"));
    if (const std::string why = base::name_refusal(reason.get<std::string>()); !why.empty())
      return answer(daemon::refusal(400, "reason: " + why));
    const base::Result<std::string> record = record_named(*body, bench_, batches_);
    if (!record) return answer(daemon::refusal(400, record.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.void_test(*record, reason.get<std::string>(), request.controller,
                       reply_with_batch(batches_, answer));
  }

  void restore_test(const daemon::HttpRequest& request, const std::string&,
                    const daemon::HttpAnswer& answer) {
    const auto body = object_of(request.body, {"test", "record"});
    if (!body) return answer(daemon::refusal(400, body.error().message));
    const base::Result<std::string> record = record_named(*body, bench_, batches_);
    if (!record) return answer(daemon::refusal(400, record.error().message));
    if (!take(request, Lease::kCommand_s, answer)) return;
    batches_.restore(*record, request.controller, reply_with_batch(batches_, answer));
  }

  void batches(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer(daemon::reply_of(batches_json(batches_.book())));
  }
  void report(const daemon::HttpRequest& request, const std::string& rest, const daemon::HttpAnswer& answer) {
    answer_report(request, rest, batches_.book(), bench_.reports(), answer);
  }
  void compare(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    answer_comparison(request, batches_.book(), bench_.reports(), answer);
  }

  void arm(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    command(daemon::Command::Kind::kArm, request, {}, answer);
  }
  void start(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    command(daemon::Command::Kind::kStart, request, "test", answer);
  }
  void stop(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    command(daemon::Command::Kind::kStop, request, "test", answer);
  }
  void mark(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    command(daemon::Command::Kind::kMark, request, "text", answer);
  }
  void tare(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    command(daemon::Command::Kind::kTare, request, {}, answer);
  }

  /// \param key  the only key that the body may have; empty: none.
  void command(daemon::Command::Kind kind, const daemon::HttpRequest& request, std::string_view key,
               const daemon::HttpAnswer& answer) {
    const auto body = object_of(request.body, {key});
    if (!body) return answer(daemon::refusal(400, body.error().message));
    daemon::Command command{kind, request.controller, {}, {}};
    if (body->contains("test")) {
      const Json& test = body->at("test");
      if (!test.is_number_integer() || test < 1)
        return answer(daemon::refusal(400, "test: must be a whole number from 1 on"));
      command.test = test.get<std::int64_t>();
    }
    if (kind == daemon::Command::Kind::kMark) {
      const Json text = body->value("text", Json());
      if (!text.is_string() || text.get<std::string>().empty())
        return answer(daemon::refusal(400, "text: is missing: what is to be noted?"));
      command.text = text.get<std::string>();
      if (const std::string why = base::name_refusal(command.text); !why.empty())
        return answer(daemon::refusal(400, "text: " + why));
    }
    if (!take(request, Lease::kCommand_s, answer)) return;
    bench_.command(std::move(command), [kind, answer](const daemon::Outcome& outcome) {
      const pipeline::TareReport& report = outcome.report;
      if (!report.refusal.empty()) {
        answer(
            {409, io::json_text({{"error", report.refusal}, {"bench", pipeline::name(report.state)}}), {}});
        return;
      }
      Json json{{"bench", pipeline::name(report.state)},
                {"test", report.test},
                {"scan", report.scan},
                {"already", outcome.already}};
      if (kind == daemon::Command::Kind::kTare) {
        json["zero"] = report.zero_V;
        json["zero_standard_error"] = report.zero_standard_error_V;
        json["moved_force"] = report.moved_N;
        json["scan_count"] = report.scan_count;
      }
      answer(daemon::reply_of(json));
    });
  }

  // The load cell's calibration.

  void calibration(const daemon::HttpRequest&, const std::string&, const daemon::HttpAnswer& answer) {
    answer(daemon::reply_of(daemon::calibration_json(bench_.calibrator().view())));
  }
  void calibrate(const daemon::HttpRequest& request, const std::string&, const daemon::HttpAnswer& answer) {
    daemon::Warnings warnings;
    const base::Result<CalibrationStep> step = calibration_step(request, warnings);
    if (!step) return answer(daemon::refusal(400, step.error().message));
    if (!take(request, Lease::kCalibration_s, answer)) return;
    daemon::Calibrator& calibrator = bench_.calibrator();
    (*step)(calibrator, [this, &calibrator, who = request.controller,
                         answer = warned(answer, warnings)](const daemon::CalibrationRefusal& refusal) {
      if (refusal.why.empty()) {
        // Nobody waits for the time that a weight would have taken.
        if (!calibrator.view().session) lease_.end_task(who, now_ns());
        return answer(daemon::reply_of(daemon::calibration_json(calibrator.view())));
      }
      Json json{{"error", refusal.why}};
      if (refusal.gain_change) {
        json["code"] = daq::kGainChangeCode;
        json["gain_change"] = daemon::gain_change_json(refusal.gain_change);
      }
      answer({409, io::json_text(json), {}});
    });
  }

  daemon::Bench& bench_;
  daemon::Batches& batches_;
  const base::Clock& clock_;
  Lease& lease_;
  Repeats repeats_;
};

const std::array<Api::Route, 32> Api::kRoutes{{
    {"GET", "/v1/status", false, &Api::status},
    {"GET", "/v1/openapi.json", false, &Api::description},
    {"GET", "/v1/tests", false, &Api::tests},
    {"GET", "/v1/tests/", false, &Api::test},
    {"GET", "/v1/records", false, &Api::records},
    {"GET", "/v1/records/", false, &Api::record},
    {"GET", "/v1/trend", false, &Api::trend},
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

daemon::HttpHandler make_api(daemon::Bench& bench, const base::Clock& clock, Lease& lease) {
  auto api = std::make_shared<Api>(bench, clock, lease);
  return [api](const daemon::HttpRequest& request, daemon::HttpAnswer answer) {
    api->handle(request, std::move(answer));
  };
}

}  // namespace stickslip::control
