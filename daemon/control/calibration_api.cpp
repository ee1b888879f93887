#include "daemon/control/calibration_api.hpp"

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "daemon/control/request_body.hpp"
#include "daemon/types/calibration_json.hpp"

namespace stickslip::control {
namespace {

using Answer = daemon::Calibrator::Answer;

base::Result<CalibrationStep> begin(const daemon::HttpRequest& request, daemon::Warnings& warnings) {
  const auto body = object_of(request.body, {"settle", "reading", "settle_s", "reading_s"});
  if (!body) return tl::unexpected(body.error());
  const auto times = daemon::weighing_times_of(*body, &warnings);
  if (!times) return tl::unexpected(times.error());
  return [who = request.controller, times = *times](daemon::Calibrator& calibrator, Answer answer) {
    calibrator.begin(who, times, std::move(answer));
  };
}

base::Result<CalibrationStep> weigh(const daemon::HttpRequest& request) {
  const auto body = object_of(request.body, {"mass", "mass_kg"});
  if (!body) return tl::unexpected(body.error());
  const auto mass_kg = daemon::mass_of(*body);
  if (!mass_kg) return tl::unexpected(mass_kg.error());
  return [mass_kg = *mass_kg](daemon::Calibrator& calibrator, Answer answer) {
    calibrator.weigh(mass_kg, std::move(answer));
  };
}

base::Result<CalibrationStep> finish(const daemon::HttpRequest& request) {
  const auto body = object_of(request.body, {"certificate", "valid_days", "confirm"});
  if (!body) return tl::unexpected(body.error());
  const auto paper = daemon::paper_of(*body);
  if (!paper) return tl::unexpected(paper.error());
  return [who = request.controller, paper = *paper](daemon::Calibrator& calibrator, Answer answer) {
    calibrator.finish(who, paper, std::move(answer));
  };
}

}  // namespace

base::Result<CalibrationStep> calibration_step(const daemon::HttpRequest& request,
                                               daemon::Warnings& warnings) {
  const std::string path = request.target.substr(0, request.target.find('?'));
  if (path.ends_with("/weight")) return weigh(request);
  if (path.ends_with("/finish")) return finish(request);
  if (path.ends_with("/undo"))
    return [](daemon::Calibrator& calibrator, const Answer& answer) { answer(calibrator.undo()); };
  if (request.method == "DELETE")
    return [](daemon::Calibrator& calibrator, const Answer& answer) { answer(calibrator.give_up()); };
  return begin(request, warnings);
}

}  // namespace stickslip::control
