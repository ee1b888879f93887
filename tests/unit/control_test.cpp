#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "daemon/control/access.hpp"
#include "daemon/control/api.hpp"
#include "daemon/control/repeats.hpp"
#include "daemon/types/live_hub.hpp"
#include "tests/support/manual_clock.hpp"
#include "tests/unit/paper_bench.hpp"

namespace stickslip::daemon {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

class ControlApi : public testing::Test {
 protected:
  /// Status 0: it has not been answered yet.
  HttpReply ask(const HttpRequest& request) {
    const auto got = std::make_shared<HttpReply>();
    got->status = 0;
    api_(request, [got](HttpReply reply) { *got = std::move(reply); });
    return *got;
  }
  HttpReply command(const std::string& path, const std::string& who, const std::string& body = "",
                    const std::string& key = "") {
    return ask({"POST", path, body, who, key});
  }
  static std::string error(const HttpReply& reply) { return json::parse(reply.body)["error"]; }

  test::ManualClock clock_;
  control::Lease lease_;
  PaperBench bench_;
  HttpHandler api_ = control::make_api(bench_, clock_, lease_);
};

TEST_F(ControlApi, ACalibrationIsAskedForWithUnits) {
  const HttpReply begun = command("/v1/calibration", "ada", R"({"settle": "500 ms", "reading": 3})");
  EXPECT_EQ(begun.status, 200);
  EXPECT_THAT(begun.warning,
              testing::HasSubstr(R"(reading: "3": a time needs its unit; it is read as "3 s")"));
  EXPECT_EQ(command("/v1/calibration/weight", "ada", R"({"mass": "500 g"})").status, 200);
  EXPECT_EQ(command("/v1/calibration/weight", "ada", R"({"mass_kg": 2})").status, 200);
  const HttpReply refused = command("/v1/calibration/weight", "ada", R"({"mass": 500})");
  EXPECT_EQ(refused.status, 400);
  EXPECT_THAT(error(refused),
              testing::HasSubstr(R"("500": a mass needs its unit, such as "500 g" or "500 kg")"));
  EXPECT_EQ(error(command("/v1/calibration/undo", "ada")), "nothing has been read yet");
  // Between two weights nobody else gets the bench: 31 s are more than a command has it.
  clock_.advance(31s);
  EXPECT_THAT(error(command("/v1/stop", "bob")), testing::HasSubstr("ada has the bench"));
  EXPECT_EQ(command("/v1/calibration/finish", "ada", R"({"certificate": "DKD", "valid_days": 0})").status,
            200);
  EXPECT_THAT(bench_.calibrations.asked,
              testing::ElementsAre("ada begins 0.5 3", "weigh 0.5", "weigh 2", "ada finishes DKD 0"));
  EXPECT_EQ(command("/v1/stop", "bob").status, 200) << "what is saved gives the bench back";
  const json told = json::parse(ask({"GET", "/v1/calibration", "", "", ""}).body);
  EXPECT_EQ(told["in_use"]["gain"], 2.0);
  EXPECT_EQ(told["in_use"]["date"], nullptr);
}

TEST_F(ControlApi, AChangedGainIsKeptOnceItIsConfirmed) {
  bench_.calibrations.gain_change = daq::gain_change(2000.0, 2.0);
  const HttpReply refused = command("/v1/calibration/finish", "ada", R"({"certificate": "DKD"})");
  EXPECT_EQ(refused.status, 409);
  const json why = json::parse(refused.body);
  EXPECT_EQ(why["code"], "gain-change");
  EXPECT_EQ(why["gain_change"]["ratio"], 1000.0);
  EXPECT_EQ(why["gain_change"]["gain_in_use"], 2.0);
  EXPECT_EQ(command("/v1/calibration/finish", "ada", R"({"confirm": 1})").status, 400);
  EXPECT_EQ(command("/v1/calibration/finish", "ada", R"({"certificate": "DKD", "confirm": true})").status,
            200);
  EXPECT_THAT(bench_.calibrations.asked, testing::ElementsAre("ada finishes DKD 365 confirmed"));
}

TEST_F(ControlApi, LeadsABatchWhichPeopleMayNotPlanAgainst) {
  EXPECT_EQ(json::parse(ask({"GET", "/v1/batch", "", "", ""}).body)["batch"], nullptr);
  EXPECT_EQ(command("/v1/batch", "ada", R"({"replicates": 2})").status, 400);
  const HttpReply begun = command("/v1/batch", "ada", R"({"name": "liner", "replicates": 2})");
  EXPECT_EQ(begun.status, 200) << begun.body;
  const json batch = json::parse(begun.body)["batch"];
  EXPECT_EQ(batch["planned"], 2);
  EXPECT_EQ(batch["next"]["replicate"], 1);
  EXPECT_EQ(batch["by"], "ada");
  const HttpReply planned = ask({"PUT", "/v1/plan", R"({"name": "x"})", "ada", ""});
  EXPECT_EQ(planned.status, 409);
  EXPECT_THAT(error(planned),
              testing::HasSubstr("(liner) states all but some facts of its tests: end it first"));
  EXPECT_EQ(ask({"DELETE", "/v1/batch", "", "ada", ""}).status, 200);
  EXPECT_EQ(ask({"PUT", "/v1/plan", R"({"name": "x"})", "ada", ""}).status, 200);
}

TEST_F(ControlApi, VoidsATestByItsNumberOrRecordAndSaysSoInTheList) {
  for (const auto& [body, why] : std::initializer_list<std::pair<const char*, const char*>>{
           {R"({"test": 7})", "reason: is missing"},
           {R"({"test": 7, "reason": ""})", "reason: is missing"},
           {R"({"test": 7, "reason": "a\nb"})", "control character"},
           {R"({"reason": "torn"})", "which test?"},
           {R"({"test": 7, "record": "x", "reason": "torn"})", "which test?"},
           {R"({"test": 8, "reason": "torn"})", "there is no 8"},
           {R"({"test": "7", "reason": "torn"})", "there is no \"7\""},
           {R"({"record": "../../etc/passwd", "reason": "torn"})", "none of the latest tests"},
           {R"({"record": 7, "reason": "torn"})", "record: must be text"},
       }) {
    const HttpReply refused = command("/v1/void", "ada", body);
    EXPECT_EQ(refused.status, 400) << body;
    EXPECT_THAT(error(refused), testing::HasSubstr(why)) << body;
  }
  EXPECT_EQ(command("/v1/void", "ada", R"({"test": 7, "reason": "paper torn"})").status, 200);
  const json test = json::parse(ask({"GET", "/v1/tests/7", "", "", ""}).body);
  EXPECT_EQ(test["voided"]["reason"], "paper torn");
  EXPECT_EQ(json::parse(ask({"GET", "/v1/tests", "", "", ""}).body)["tests"][0]["voided"]["by"], "ada");
  EXPECT_EQ(command("/v1/restore", "ada", R"({"record": "20261121T125252Z-0007.h5"})").status, 200);
  EXPECT_EQ(command("/v1/restore", "ada", R"({"test": 7})").status, 409);
  EXPECT_EQ(json::parse(ask({"GET", "/v1/tests/7", "", "", ""}).body)["voided"], nullptr);
}

TEST_F(ControlApi, ListsBatchesTheLatestFirst) {
  const auto list = [this] { return json::parse(ask({"GET", "/v1/batches", "", "", ""}).body)["batches"]; };
  EXPECT_EQ(list(), json::array());
  command("/v1/batch", "ada", R"({"name": "liner", "grade": "kraft"})");
  command("/v1/batch", "ada", R"({"name": "fluting"})");
  const json batches = list();
  ASSERT_EQ(batches.size(), 2U);
  EXPECT_EQ(batches[0]["name"], "fluting");
  EXPECT_EQ(batches[0]["grade"], nullptr);
  EXPECT_EQ(batches[0]["ended"], nullptr);
  EXPECT_EQ(batches[1]["id"], "20261122T180301Z");
  EXPECT_EQ(batches[1]["grade"], "kraft");
  EXPECT_EQ(batches[1]["counted"], 0);
  EXPECT_NE(batches[1]["ended"], nullptr);
}

TEST_F(ControlApi, ReportsOnABatchAndComparesTwo) {
  command("/v1/batch", "ada", R"({"name": "liner"})");
  command("/v1/batch", "ada", R"({"name": "fluting"})");
  const auto get = [this](const std::string& target) { return ask({"GET", target, "", "", ""}); };
  const std::string one = "/v1/batches/20261122T180301Z/report";
  const std::string two = "/v1/compare?a=20261122T180301Z&b=20261122T180302Z";
  for (const auto& [target, body, type] : std::initializer_list<std::array<std::string, 3>>{
           {one, "form 0: 20261122T180301Z liner (20261122T180301Z)", "text/html; charset=utf-8"},
           {one + "?format=csv", "form 1: 20261122T180301Z liner (20261122T180301Z)",
            "text/csv; charset=utf-8"},
           {one + "?format=json", "\"form 2: 20261122T180301Z liner (20261122T180301Z)\"",
            "application/json"},
           {two,
            "form 0: 20261122T180301Z liner (20261122T180301Z) 20261122T180302Z fluting (20261122T180302Z)",
            "text/html; charset=utf-8"},
           {one + "?pool=grades", "form 0: 20261122T180301Z liner (20261122T180301Z) pool grades",
            "text/html; charset=utf-8"},
           {one + "?format=csv&pool=regimes",
            "form 1: 20261122T180301Z liner (20261122T180301Z) pool regimes", "text/csv; charset=utf-8"},
           {two + "&pool=grades,regimes&format=csv",
            "form 1: 20261122T180301Z liner (20261122T180301Z) 20261122T180302Z fluting (20261122T180302Z) "
            "pool grades,regimes",
            "text/csv; charset=utf-8"},
           {two + "&pool=grades%2cregimes&format=csv",
            "form 1: 20261122T180301Z liner (20261122T180301Z) 20261122T180302Z fluting (20261122T180302Z) "
            "pool grades,regimes",
            "text/csv; charset=utf-8"},
       }) {
    const HttpReply reply = get(target);
    EXPECT_EQ(reply.status, 200) << target;
    EXPECT_EQ(reply.body, body);
    EXPECT_EQ(reply.content_type, type);
  }
  for (const auto& [target, status, why] : std::initializer_list<std::tuple<std::string, int, const char*>>{
           {one + "?format=pdf", 400, "format: is html, csv or json, not pdf"},
           {one + "?format", 400, "format: is html, csv or json, not "},
           {one + "?form=csv", 400, "form: there is no such key"},
           {one + "?format=csv&format=csv", 400, "format: stands there twice; send it once"},
           {one + "?pool=all", 400, "pool: is grades or regimes or grades,regimes, not all"},
           {one + "?pool=%", 400, "pool: two hexadecimal digits are needed after each %"},
           {one + "?pool=%1", 400, "pool: two hexadecimal digits are needed after each %"},
           {one + "?pool=%+1", 400, "pool: two hexadecimal digits are needed after each %"},
           {one + "?pool=%1b", 400, "not \\x1b"},
           {one + "?pool=", 400, "pool: is grades or regimes or grades,regimes, not "},
           {one + "?pool=regimes,grades", 400, "not regimes,grades"},
           {one + "?pool=grades&pool=regimes", 400, "pool: stands there twice; send it once"},
           {two + "&pool=speeds", 400, "pool: is grades or regimes or grades,regimes, not speeds"},
           {"/v1/batches/liner/report", 404, "there is no batch liner"},
           {"/v1/batches/../report", 404, "there is no batch .."},
           {"/v1/batches//report", 404, "there is no batch ;"},
           {"/v1/batches/20261122T180301Z", 404, "/v1/batches/ID/report is the report"},
           {"/v1/batches/20261122T180301Z/report/", 404, "/v1/batches/ID/report is the report"},
           {"/v1/compare", 400, "which two batches?"},
           {"/v1/compare?a=20261122T180301Z", 400, "which two batches?"},
           {"/v1/compare?a=20261122T180301Z&b=x%0A", 404, "there is no batch x\\x0a"},
           {"/v1/compare?a=20261122T180301Z&b=20261122T180301Z", 400, "are the same batch"},
       }) {
    const HttpReply refused = get(target);
    EXPECT_EQ(refused.status, status) << target;
    EXPECT_THAT(error(refused), testing::HasSubstr(why)) << target;
  }
  bench_.reported.refusal = base::Error{base::ErrorKind::kBusy, "another report"};
  EXPECT_EQ(get(two).status, 503);
  bench_.reported.refusal = base::Error{base::ErrorKind::kFailure, "no test yet"};
  EXPECT_EQ(get(one).status, 409);
}

TEST_F(ControlApi, ATraceIsThatOfTheRecordOfItsTest) {
  const std::string trace = "/v1/tests/7/trace";
  const auto get = [this](const std::string& target) { return ask({"GET", target, "", "", ""}); };
  EXPECT_EQ(get(trace).body, "\"trace /records/20261121T125252Z-0007.h5 2000 -1 -1\"");
  EXPECT_EQ(get(trace + "?points=800&from=1.25&to=2").body,
            "\"trace /records/20261121T125252Z-0007.h5 800 1.25 2\"");
  for (const auto& [target, status, why] : std::initializer_list<std::tuple<std::string, int, const char*>>{
           {trace + "?points=0", 400, "points: must be a whole number from 1 to 20000, not 0"},
           {trace + "?points=1e9", 400, "points: must be a whole number from 1 to 20000, not 1e9"},
           {trace + "?from=-1", 400, "from: must be seconds after the first scan, 0 or more, not -1"},
           {trace + "?from=2&to=1", 400, "to: must be above from, 2 s, not 1"},
           {"/v1/tests/8/trace", 404, "there is no test 8"},
           {"/v1/tests//trace", 404, "there is no test"},
       }) {
    const HttpReply refused = get(target);
    EXPECT_EQ(refused.status, status) << target;
    EXPECT_THAT(error(refused), testing::HasSubstr(why)) << target;
  }
  bench_.reported.refusal = base::Error{base::ErrorKind::kBusy, "another trace"};
  EXPECT_EQ(get(trace).status, 503);
}

TEST_F(ControlApi, SearchesRecordsByTheOptionsOfFind) {
  const auto get = [this](const std::string& target) { return ask({"GET", target, "", "", ""}); };
  EXPECT_EQ(get("/v1/records").body, "\"most 100\"");
  // Several ranges, regimes and findings have a comma between; a text may hold one.
  EXPECT_EQ(
      get("/v1/records?sample=liner%2C%20a*&grade=&where=S%3D0.3:0.4,K%3D:0.3&regime=mixed&most=1000").body,
      "\"most 1000 regime=mixed sample=liner, a* where=S=0.3:0.4 where=K=:0.3\"");
  for (const auto& [query, why] : std::initializer_list<std::pair<std::string, const char*>>{
           {"most=0", "most: must be a whole number from 1 to 1000, not 0"},
           {"most=1001", "most: must be a whole number from 1 to 1000, not 1001"},
           {"folder=/etc", "folder: there is no such key; there is from, to, sample"},
           {"sample=%00", "sample: holds a zero byte"},
           {"sample=a&sample=b", "sample: stands there twice"}}) {
    const HttpReply refused = get("/v1/records?" + query);
    EXPECT_EQ(refused.status, 400) << query;
    EXPECT_THAT(error(refused), testing::HasSubstr(why)) << query;
  }
  for (const auto& [kind, status] : {std::pair{base::ErrorKind::kUsage, 400},
                                     {base::ErrorKind::kBusy, 503},
                                     {base::ErrorKind::kFailure, 409}}) {
    bench_.reported.refusal = base::Error{kind, "why"};
    EXPECT_EQ(get("/v1/records").status, status);
  }
}

TEST_F(ControlApi, GivesTraceAndReportOfAnyRecordByItsName) {
  const auto get = [this](const std::string& target) { return ask({"GET", target, "", "", ""}); };
  const std::string old = "/v1/records/2026/old%20one.h5";
  EXPECT_EQ(get(old + "/trace?points=80").body, "\"trace /records/2026/old one.h5 80 -1 -1\"");
  EXPECT_EQ(get("/v1/records/20261121T125252Z-0007.h5/trace").body,
            "\"trace /records/20261121T125252Z-0007.h5 2000 -1 -1\"");
  EXPECT_EQ(get(old + "/report").body, "\"form 0: /records/2026/old one.h5\"");
  EXPECT_EQ(get(old + "/report?format=csv").content_type, "text/csv; charset=utf-8");
  for (const auto& [target, status, why] : std::initializer_list<std::tuple<std::string, int, const char*>>{
           {old + "/trace?points=0", 400, "points: must be a whole number from 1 to 20000, not 0"},
           {old + "/report?format=pdf", 400, "format: is html, csv or json, not pdf"},
           {old + "/report?pool=grades", 400, "pool: there is no such key; there is format"},
           {"/v1/records/x.h5/trace", 404, "there is no record x.h5"},
           {"/v1/records/x.h5/report", 404, "there is no record x.h5"},
           {"/v1/records/x.h5", 404, "there is no record x.h5"}}) {
    const HttpReply refused = get(target);
    EXPECT_EQ(refused.status, status) << target;
    EXPECT_THAT(error(refused), testing::HasSubstr(why)) << target;
  }
  command("/v1/void", "ada", R"({"test": 7, "reason": "paper torn"})");
  const HttpReply voided = get("/v1/records/20261121T125252Z-0007.h5/trace");
  EXPECT_EQ(voided.status, 409);
  EXPECT_THAT(error(voided), testing::HasSubstr("20261121T125252Z-0007.h5 is void: paper torn"));
}

TEST_F(ControlApi, GivesTheControlCharts) {
  const HttpReply reply = ask({"GET", "/v1/trend", "", "", ""});
  EXPECT_EQ(reply.status, 200);
  EXPECT_EQ(json::parse(reply.body)["charts"], json::array());
}

TEST_F(ControlApi, TellsTheStatusByTheNamesOfTheRecord) {
  const HttpReply reply = ask({"GET", "/v1/status", "", "", ""});
  EXPECT_EQ(reply.status, 200);
  const json status = json::parse(reply.body);
  EXPECT_EQ(status["state"], "acquiring");
  EXPECT_EQ(status["bench"], "running");
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
  EXPECT_EQ(status["storage"]["lacks"], json::array());
  EXPECT_EQ(status["latest_test"]["results"]["mu_s"], 0.35);
  EXPECT_EQ(status["latest_test"]["results"]["mu_k"], nullptr);
}

TEST_F(ControlApi, RefusesWithTheReason) {
  const HttpReply absent = ask({"GET", "/v1/nothing\x01", "", "", ""});
  EXPECT_EQ(absent.status, 404);
  EXPECT_EQ(error(absent), R"(there is nothing at /v1/nothing\x01; /v1/openapi.json says what there is)");
  const HttpReply method = ask({"POST", "/v1/status", "", "", ""});
  EXPECT_EQ(method.status, 405);
  EXPECT_EQ(method.allow, "GET");
  EXPECT_EQ(error(method), "POST is not allowed at /v1/status; GET is");
  EXPECT_EQ(ask({"POST", "/v1/plan", "", "ada", ""}).allow, "GET, PUT");
}

// Names of devices and files come from outside and may be no UTF-8.
TEST_F(ControlApi, SurvivesNamesThatAreNoText) {
  Status status;
  status.detail = "\xff";
  EXPECT_TRUE(json::accept(health_frame(status)));
}

TEST_F(ControlApi, ListsTestsAndShowsOneWithAllDetails) {
  const json list = json::parse(ask({"GET", "/v1/tests", "", "", ""}).body);
  ASSERT_EQ(list["tests"].size(), 1U);
  EXPECT_EQ(list["tests"][0]["number"], 7);
  EXPECT_FALSE(list["tests"][0]["results"].contains("details"));
  const json shown = json::parse(ask({"GET", "/v1/tests/7", "", "", ""}).body);
  EXPECT_EQ(shown["results"]["details"]["mu_k"]["reason"], "no slip");
  for (const char* number : {"8", "7x", "-7", "99999999999999999999", "7/x", "%37"}) {
    EXPECT_EQ(ask({"GET", std::string{"/v1/tests/"} + number, "", "", ""}).status, 404) << number;
  }
}

TEST_F(ControlApi, NobodyCommandsWithoutAName) {
  EXPECT_THAT(error(command("/v1/start", "")), testing::HasSubstr("Stickslip-Controller"));
  EXPECT_EQ(command("/v1/start", std::string(65, 'a')).status, 400);
  EXPECT_EQ(command("/v1/start", "\xff").status, 400);
  EXPECT_EQ(command("/v1/start", "a\tb").status, 400);
  EXPECT_TRUE(bench_.commands.empty());
  const HttpReply done = command("/v1/start", "Ada \"the first\"");
  EXPECT_EQ(done.status, 200);
  EXPECT_EQ(json::parse(done.body),
            json::parse(R"({"bench": "loading", "test": 8, "scan": 1234, "already": false})"));
  EXPECT_EQ(bench_.commands.at(0).who, "Ada \"the first\"");
}

TEST_F(ControlApi, OneAtATimeCommandsUntilTheLeaseIsOver) {
  EXPECT_EQ(command("/v1/arm", "ada").status, 200);
  const HttpReply refused = command("/v1/stop", "bob");
  EXPECT_EQ(refused.status, 409);
  EXPECT_EQ(error(refused),
            "ada has the bench for another 30 s; one at a time commands, all may read. Take it over with "
            "\"Take it over …\" of the live page, or PUT /v1/controller {\"from\":\"ada\"}");
  EXPECT_EQ(bench_.commands.size(), 1U);
  EXPECT_EQ(ask({"PUT", "/v1/plan", "{}", "bob", ""}).status, 409);
  EXPECT_EQ(error(ask({"DELETE", "/v1/controller", "", "bob", ""})), error(refused));
  EXPECT_EQ(json::parse(ask({"GET", "/v1/controller", "", "", ""}).body)["controller"], "ada");
  clock_.advance(29'999'999'999ns);
  EXPECT_EQ(command("/v1/stop", "bob").status, 409);
  clock_.advance(1ns);
  EXPECT_EQ(json::parse(ask({"GET", "/v1/controller", "", "", ""}).body)["controller"], nullptr);
  EXPECT_EQ(command("/v1/stop", "bob").status, 200);
  EXPECT_EQ(ask({"DELETE", "/v1/controller", "", "bob", ""}).status, 200);
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"seconds": 3600})", "ada", ""}).status, 200);
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"seconds": 1})", "ada", ""}).status, 200);
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"seconds": 1, "from": "ada"})", "ada", ""}).status, 200);
  clock_.advance(3500s);
  // A command makes a lease longer, never shorter.
  EXPECT_EQ(command("/v1/arm", "ada").status, 200);
  EXPECT_NEAR(json::parse(ask({"GET", "/v1/controller", "", "", ""}).body)["seconds_left"].get<double>(),
              100.0, 1e-6);
  // Taken over from who has it, and from nobody else.
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"from": "eve"})", "bob", ""}).status, 409);
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"from": "ada"})", "bob", ""}).status, 200);
  EXPECT_EQ(error(command("/v1/stop", "ada")),
            "bob has the bench for another 30 s; one at a time commands, all may read. Take it over with "
            "\"Take it over …\" of the live page, or PUT /v1/controller {\"from\":\"bob\"}");
  // The request that a refusal names is granted, whatever the name.
  const std::string odd = "Łoś \"the\\ first\"";
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"from": "bob"})", odd, ""}).status, 200);
  const std::string told = error(ask({"PUT", "/v1/controller", R"({"from": "bob"})", "eve", ""}));
  EXPECT_THAT(told, testing::StartsWith(odd + " has the bench"));
  EXPECT_EQ(ask({"PUT", "/v1/controller", told.substr(told.find('{')), "bob", ""}).status, 200);
  EXPECT_EQ(ask({"PUT", "/v1/controller", R"({"from": "bob", "seconds": 3600})", "ada", ""}).status, 200);
  for (const char* body : {R"({"seconds": 0})", R"({"from": 1})", R"({"seconds": 3601})",
                           R"({"seconds": "x"})", R"({"second": 1})", "[]", "{"}) {
    EXPECT_EQ(ask({"PUT", "/v1/controller", body, "ada", ""}).status, 400) << body;
  }
}

TEST_F(ControlApi, WhatEndsACalibrationDoesNotShortenALeaseThatWasAskedFor) {
  const auto left_s = [this] { return lease_.state(clock_.monotonic_ns()).seconds_left; };
  ASSERT_EQ(ask({"PUT", "/v1/controller", R"({"seconds": 3600})", "ada", ""}).status, 200);
  ASSERT_EQ(command("/v1/calibration", "ada").status, 200);
  ASSERT_EQ(command("/v1/calibration/finish", "ada", R"({"certificate": "DKD", "valid_days": 0})").status,
            200);
  EXPECT_NEAR(left_s(), 3600.0, 1e-6);
  EXPECT_EQ(command("/v1/stop", "bob").status, 409);
  // A step takes it longer than was asked for; its end gives that part back.
  clock_.advance(3500s);
  ASSERT_EQ(command("/v1/calibration", "ada").status, 200);
  EXPECT_NEAR(left_s(), control::Lease::kCalibration_s, 1e-6);
  ASSERT_EQ(ask({"DELETE", "/v1/calibration", "", "ada", ""}).status, 200);
  EXPECT_NEAR(left_s(), 100.0, 1e-6);
  // What another one, or the same one earlier, asked for is no longer there.
  ASSERT_EQ(ask({"DELETE", "/v1/controller", "", "ada", ""}).status, 200);
  for (const char* who : {"ada", "bob"}) {
    ASSERT_EQ(command("/v1/calibration", who).status, 200);
    ASSERT_EQ(ask({"DELETE", "/v1/calibration", "", who, ""}).status, 200);
    EXPECT_EQ(left_s(), 0.0) << who;
  }
}

TEST_F(ControlApi, ARepeatedKeyIsAnsweredAsThenAndNothingIsDoneTwice) {
  const HttpReply first = command("/v1/mark", "ada", R"({"text": "here"})", "k1");
  const HttpReply again = command("/v1/mark", "ada", R"({"text": "here"})", "k1");
  EXPECT_EQ(first.status, 200);
  EXPECT_FALSE(first.replayed);
  EXPECT_TRUE(again.replayed);
  EXPECT_EQ(again.body, first.body);
  EXPECT_EQ(bench_.commands.size(), 1U);
  EXPECT_EQ(command("/v1/mark", "ada", R"({"text": "there"})", "k1").status, 422);
  EXPECT_EQ(command("/v1/mark", "ada", R"({"text": "here"})", "k2").status, 200);
  EXPECT_EQ(bench_.commands.size(), 2U);
  EXPECT_EQ(command("/v1/mark", "ada", R"({"text": "here"})", std::string(129, 'k')).status, 400);
  bench_.later = true;
  EXPECT_EQ(command("/v1/arm", "ada", "", "k3").status, 0) << "no answer yet";
  EXPECT_EQ(command("/v1/arm", "ada", "", "k3").status, 409);
  bench_.waiting();
  EXPECT_TRUE(command("/v1/arm", "ada", "", "k3").replayed);
}

TEST_F(ControlApi, ARefusalIsNotKept) {
  bench_.refusal = "a test is running";
  EXPECT_EQ(command("/v1/start", "ada", "", "k").status, 409);
  EXPECT_EQ(command("/v1/start", "ada", R"({"test": "x"})", "k").status, 400);
  bench_.refusal.clear();
  const HttpReply granted = command("/v1/start", "ada", "", "k");
  EXPECT_EQ(granted.status, 200);
  EXPECT_FALSE(granted.replayed);
  EXPECT_TRUE(command("/v1/start", "ada", "", "k").replayed);
}

TEST_F(ControlApi, NobodyElsesKeysPushOutMine) {
  const std::string here = R"({"text": "here"})";
  const auto mark = [&](const std::string& who, const std::string& key, const std::string& peer) {
    return ask({"POST", "/v1/mark", here, who, key, peer});
  };
  const auto release = [&](const std::string& who) { ask({"DELETE", "/v1/controller", "", who, ""}); };
  ASSERT_EQ(mark("ada", "k", "uid 1000").status, 200);
  release("ada");
  for (std::size_t k = 0; k < 2 * control::Repeats::kKept; ++k) mark("bob", std::to_string(k), "uid 1000");
  release("bob");
  // The same name is somebody else's where the system says so.
  EXPECT_FALSE(mark("ada", "k", "token").replayed);
  EXPECT_TRUE(mark("ada", "k", "uid 1000").replayed);
  EXPECT_FALSE(mark("ada", "0", "uid 1000").replayed) << "it is bob's";
  // Their own oldest are forgotten.
  release("ada");
  EXPECT_FALSE(mark("bob", "0", "uid 1000").replayed);
  EXPECT_TRUE(mark("bob", std::to_string(2 * control::Repeats::kKept - 1), "uid 1000").replayed);
}

TEST_F(ControlApi, NamesWithoutEndMakeNobodyForget) {
  ASSERT_EQ(command("/v1/arm", "ada", "", "k").status, 200);
  ask({"DELETE", "/v1/controller", "", "ada", ""});
  int refused = 0;
  for (int k = 0; k < 1000; ++k) {
    const std::string name = std::to_string(k);
    const HttpReply reply = command("/v1/arm", name, "", "k");
    ask({"DELETE", "/v1/controller", "", name, ""});
    if (reply.status != 503) continue;
    ++refused;
    EXPECT_THAT(error(reply), testing::HasSubstr("send the request without a key"));
  }
  EXPECT_EQ(refused, 1001 - static_cast<int>(control::Repeats::kMostClients));
  EXPECT_TRUE(command("/v1/arm", "ada", "", "k").replayed);
  EXPECT_EQ(command("/v1/arm", "zoe", "", "").status, 200) << "without a key";
  clock_.advance(control::Repeats::kRemembered);
  EXPECT_EQ(command("/v1/arm", "zoe", "", "k").status, 200);
}

// What is remembered of one client is bounded in bytes too.
TEST_F(ControlApi, LongRequestsPushOutTheirOwn) {
  ASSERT_EQ(command("/v1/arm", "ada", "", "first").status, 200);
  const auto padded = [](int k) {
    return std::string(60'000, ' ') + R"({"text": ")" + std::to_string(k) + "\"}";
  };
  for (int k = 0; k < 20; ++k) {
    EXPECT_EQ(command("/v1/mark", "ada", padded(k), std::to_string(k)).status, 200);
    EXPECT_TRUE(command("/v1/mark", "ada", padded(k), std::to_string(k)).replayed);
  }
  EXPECT_FALSE(command("/v1/arm", "ada", "", "first").replayed);
}

TEST_F(ControlApi, RefusalsOfTheBenchSayWhyAndInWhichState) {
  bench_.refusal = "a test is running; stop it first";
  const HttpReply reply = command("/v1/start", "ada");
  EXPECT_EQ(reply.status, 409);
  EXPECT_EQ(json::parse(reply.body),
            json::parse(R"({"error": "a test is running; stop it first", "bench": "loading"})"));
}

TEST_F(ControlApi, TakesBodiesThatAreRightAndNoOthers) {
  EXPECT_EQ(command("/v1/start", "ada", R"({"test": 8})").status, 200);
  EXPECT_EQ(bench_.commands.back().test, 8);
  for (const char* body :
       {R"({"test": 0})", R"({"test": 1.5})", R"({"test": "8"})", R"({"tests": 8})", "8", "{", "\xff"}) {
    EXPECT_EQ(command("/v1/start", "ada", body).status, 400) << body;
  }
  EXPECT_EQ(command("/v1/arm", "ada", R"({"test": 8})").status, 400);
  for (const char* body : {"", "{}", R"({"text": ""})", R"({"text": 8})", R"({"text": "a\u0007"})"}) {
    EXPECT_EQ(command("/v1/mark", "ada", body).status, 400) << body;
  }
  EXPECT_EQ(command("/v1/mark", "ada", json{{"text", std::string(201, 'x')}}.dump()).status, 400);
  EXPECT_EQ(command("/v1/mark", "ada", R"({"text": "Blatt gewölbt \"links\""})").status, 200);
  EXPECT_EQ(bench_.commands.back().text, "Blatt gewölbt \"links\"");
}

TEST_F(ControlApi, ThePlanIsReplacedAsAWhole) {
  const HttpReply set = ask(
      {"PUT", "/v1/plan",
       R"({"name": "liner 42", "operator": "Ada", "replicate": 3, "pull_speed": "12 in/min"})", "ada", ""});
  EXPECT_EQ(set.status, 200) << set.body;
  EXPECT_EQ(bench_.plan().sample.name, "liner 42");
  EXPECT_EQ(bench_.plan().sample.replicate, 3);
  EXPECT_DOUBLE_EQ(*bench_.plan().pull_speed_m_per_s, 0.00508);
  EXPECT_EQ(ask({"GET", "/v1/plan", "", "", ""}).body, set.body);
  EXPECT_EQ(set.warning, "");
  const HttpReply bare = ask({"PUT", "/v1/plan", R"({"side": "wire", "pull_speed": 0.01})", "ada", ""});
  EXPECT_EQ(bare.status, 200);
  EXPECT_THAT(bare.warning, testing::HasSubstr(R"("0.01 m/s")"));
  EXPECT_EQ(bench_.plan().sample.name, "");
  EXPECT_EQ(bench_.plan().pull_speed_m_per_s, 0.01);
  for (const char* body :
       {R"({"nam": "x"})", R"({"name": 1})", R"({"replicate": 0})", R"({"replicate": 1.5})",
        R"({"pull_speed": 0})", R"({"pull_speed": "12 kg"})", R"({"pull_speed": 11})",
        R"({"pull_speed": []})", R"({"name": "a\nb"})", "[]", "x"}) {
    EXPECT_EQ(ask({"PUT", "/v1/plan", body, "ada", ""}).status, 400) << body;
  }
  EXPECT_EQ(bench_.plan().sample.side, "wire");
}

TEST_F(ControlApi, MetricsAreThoseOfTheStatus) {
  const HttpReply reply = ask({"GET", "/metrics", "", "", ""});
  EXPECT_EQ(reply.content_type, "text/plain; version=0.0.4; charset=utf-8");
  EXPECT_THAT(reply.body,
              testing::HasSubstr("\n# TYPE stickslip_scans_total counter\nstickslip_scans_total 42\n"));
  EXPECT_THAT(reply.body, testing::HasSubstr("\nstickslip_bench_state{state=\"running\"} 1\n"));
  EXPECT_THAT(reply.body, testing::HasSubstr("\nstickslip_bench_state{state=\"idle\"} 0\n"));
  EXPECT_THAT(reply.body, testing::HasSubstr("\nstickslip_scan_rate_hertz 350\n"));
}

const control::AccessPolicy kTcp{false, {"127.0.0.1:80", "localhost:80"}, "secret"};

int status_at(const control::AccessPolicy& policy, const control::AccessRequest& request) {
  const auto refused = control::access_refusal(policy, request);
  return refused ? refused->status : 200;
}

TEST(AccessPolicy, TcpWantsHostOriginAndToken) {
  const std::string_view host = "127.0.0.1:80";
  const std::string_view bearer = "Bearer secret";
  EXPECT_EQ(status_at({}, {"/v1/start", "anything", "http://evil", "", ""}), 200)
      << "the Unix socket has its own guard";
  EXPECT_EQ(status_at(kTcp, {"/v1/status", host, "", bearer, ""}), 200);
  EXPECT_EQ(status_at(kTcp, {"/v1/status", "localhost:80", "http://localhost:80", bearer, ""}), 200);
  // A name that somebody let point here.
  for (const char* other : {"", "evil", "evil:80", "127.0.0.1", "127.0.0.1:81", "127.0.0.1:80.evil"}) {
    EXPECT_EQ(status_at(kTcp, {"/v1/status", other, "", bearer, ""}), 403) << other;
    EXPECT_EQ(status_at(kTcp, {"/", other, "", "", ""}), 403) << other;
  }
  for (const char* origin :
       {"null", "http://evil", "https://127.0.0.1:80", "127.0.0.1:80", "http://127.0.0.1:80/x"}) {
    EXPECT_EQ(status_at(kTcp, {"/v1/status", host, origin, bearer, ""}), 403) << origin;
  }
  for (const char* token :
       {"", "Bearer ", "Bearer secre", "Bearer secret ", "Bearer SECRET", "secret", "Basic secret"}) {
    EXPECT_EQ(status_at(kTcp, {"/v1/status", host, "", token, ""}), 401) << token;
  }
  EXPECT_EQ(status_at(kTcp, {"/v1/live", host, "", "", "stickslip.v1, token.secret"}), 200);
  EXPECT_EQ(status_at(kTcp, {"/v1/live", host, "", "", "stickslip.v1, token.secrets"}), 401);
  EXPECT_EQ(status_at(kTcp, {"/", host, "", "", ""}), 200) << "the page asks for the token itself";
  EXPECT_EQ(status_at(kTcp, {"/page/live.js", host, "", "", ""}), 200);
  EXPECT_EQ(status_at(kTcp, {"/metrics", host, "", "", ""}), 401);
  EXPECT_EQ(status_at({false, {"127.0.0.1:80"}, ""}, {"/v1/status", host, "", "Bearer ", ""}), 401);
}

TEST(LiveHub, KeepsTheLatestFramesAsOneOfBoundedLength) {
  LiveHub hub;
  EXPECT_EQ(*hub.history(), R"({"type":"history","frames":[]})");
  for (std::size_t k = 0; k < LiveHub::kMostKept + 2; ++k)
    hub.publish_and_keep(std::make_shared<const std::string>(std::to_string(k)));
  hub.publish(std::make_shared<const std::string>("-1"));  // Not to be kept.
  const json history = json::parse(*hub.history());
  EXPECT_EQ(history["type"], "history");
  ASSERT_EQ(history["frames"].size(), LiveHub::kMostKept);
  EXPECT_EQ(history["frames"].front(), 2);
  EXPECT_EQ(history["frames"].back(), LiveHub::kMostKept + 1);
}

TEST(LiveQueue, DropsTheOldestAndSaysSo) {
  LiveQueue queue;
  for (std::size_t k = 0; k < LiveQueue::kMost; ++k) {
    EXPECT_EQ(queue.push(std::make_shared<const std::string>(std::to_string(k))), 0U);
  }
  EXPECT_EQ(queue.push(std::make_shared<const std::string>("new")), 1U);
  EXPECT_EQ(queue.dropped_count(), 1U);
  EXPECT_EQ(*queue.pop(), R"({"type":"dropped","frame_count":1})");
  EXPECT_EQ(*queue.pop(), "1");
  for (std::size_t k = 2; k < LiveQueue::kMost; ++k) EXPECT_EQ(*queue.pop(), std::to_string(k));
  EXPECT_EQ(*queue.pop(), "new");
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace stickslip::daemon
