#include "daemon/runtime/calibration_service.hpp"

#include <fmt/format.h>

#include <utility>

#include "io/calibration_file.hpp"

#include "core/evaluation/analyse.hpp"
#include "core/record/iso_time.hpp"

namespace stickslip::runtime {
namespace {

constexpr const char* kNoScans = "no scans come from the board; stickslip status says why";

/// Why no calibration can begin; empty: one can.
std::string refusal_of(const pipeline::Processor& processor) {
  switch (processor.bench()) {
    case pipeline::BenchState::kIdle:
      break;
    case pipeline::BenchState::kArmed:
      return "the bench is armed: a weight on the load cell would begin a test; stop it first";
    case pipeline::BenchState::kLoading:
    case pipeline::BenchState::kRunning:
      return "a test is running; stop it first";
    case pipeline::BenchState::kFinishing:
      return std::string{
          pipeline::step(pipeline::BenchState::kFinishing, pipeline::BenchEvent::kStart, false).refusal};
    case pipeline::BenchState::kDegraded:
      return kNoScans;
  }
  if (!processor.calibration().measures_voltage())
    return "the readings are no voltages: there is no load cell to calibrate";
  return {};
}

}  // namespace

void CalibrationService::session_began(const SessionSettings& settings) {
  session_load_cell_ = settings.load_cell;
  session_facts_ = settings.calibration;
  gravity_m_per_s2_ = settings.processor.analysis.tester.gravity_m_per_s2;
}

void CalibrationService::session_ended() {
  if (!open_) return;
  open_.reset();
  lost_why_ = "the board was lost, and what was read with it; begin again";
}

std::optional<std::string> CalibrationService::why_no_test() const {
  if (!open_) return std::nullopt;
  return fmt::format("{} calibrates the load cell; finish that or give it up first", open_->who);
}

void CalibrationService::block(const daq::ScanBlock& block) {
  if (!scans_) return;
  if (scans_->next && *scans_->next != block.first) {
    end_reading(base::failure("scans are missing: read this weight again"));
    return;
  }
  scans_->next = block.end();
  for (const double raw : block.scans()) {
    scans_->scans.add(raw);
    if (!scans_->scans.full()) continue;
    end_reading(scans_->scans.reading(scans_->mass_kg));
    return;
  }
}

void CalibrationService::blocks_ended() {
  if (scans_) end_reading(base::failure(kNoScans));
}

void CalibrationService::end_reading(const Reading& reading) {
  const auto done = std::move(scans_->done);
  scans_.reset();
  done(reading);
}

daq::WeighedCalibration CalibrationService::weighed() const {
  const Session* const session = parts_.session();
  double span_V = 0.0;
  if (session != nullptr) span_V = session->board_info().range_max_V - session->board_info().range_min_V;
  return daq::weigh(open_->readings, gravity_m_per_s2_, span_V);
}

std::optional<daq::GainChange> CalibrationService::change_of(const daq::WeighedCalibration& result) const {
  if (!result.fit.load_cell) return std::nullopt;
  return daq::gain_change(result.fit.load_cell->gain_N_per_V,
                          parts_.config.bench.load_cell(session_load_cell_).gain_N_per_V);
}

daemon::CalibrationView CalibrationService::view() const {
  daemon::CalibrationView view;
  const io::BenchConfig& bench = parts_.config.bench;
  view.load_cell = bench.load_cell(session_load_cell_);
  view.facts = bench.calibration.value_or(session_facts_);
  view.expired = io::expired(view.facts, record::iso_time(parts_.now_ns()));
  view.folder = bench.calibration_folder.string();
  view.file = file_.string();
  if (open_ && open_->granted) {
    view.session = {open_->who, open_->times, open_->being_read_kg, weighed(), {}};
    view.session->gain_change = change_of(view.session->weighed);
  }
  return view;
}

void CalibrationService::begin(const std::string& who, const daq::WeighingTimes& times, Answer answer) {
  if (auto why_not = why_no_test()) return answer(*std::move(why_not));
  if (parts_.config.bench.calibration_folder.empty()) {
    return answer(
        "[tester] calibration names no folder for it in the configuration: a new calibration would be lost "
        "at the next start");
  }
  Session* const session = parts_.session();
  // From here on no test can begin.
  open_ = Open{who, times, false, std::nullopt, {}};
  const std::uint64_t number = ++number_;
  const bool posted =
      session != nullptr && session->post([this, number, answer](pipeline::Processor& processor) {
        parts_.on_main([this, number, answer, why_not = refusal_of(processor)] {
          if (!open_ || number != number_) return answer(kNoScans);
          open_->granted = why_not.empty();
          if (!open_->granted) open_.reset();
          answer(why_not);
        });
      });
  if (posted) return;
  open_.reset();
  answer(kNoScans);
}

std::string CalibrationService::not_ready() const {
  if (!open_ || !open_->granted) {
    return lost_why_.empty() ? "no calibration is under way; begin one first"
                             : fmt::format("no calibration is under way: {}", lost_why_);
  }
  if (open_->being_read_kg) return "a weight is being read; wait for it";
  return {};
}

void CalibrationService::weigh(double mass_kg, Answer answer) {
  if (std::string why_not = not_ready(); !why_not.empty()) return answer(std::move(why_not));
  if (open_->readings.empty() && mass_kg != 0.0)
    return answer("the first reading is the tare: take everything off, hook and pan stay, and give mass 0");
  Session* const session = parts_.session();
  open_->being_read_kg = mass_kg;
  const std::uint64_t number = number_;
  const auto done = [this, number, answer](const Reading& reading) {
    parts_.on_main([this, number, answer, reading] {
      if (!open_ || number != number_) return answer("the calibration was given up");
      was_read(reading, answer);
    });
  };
  const bool posted = session != nullptr && session->post([this, mass_kg, done, times = open_->times,
                                                           session](pipeline::Processor&) {
    // Of one that was given up meanwhile.
    if (scans_) end_reading(base::failure("given up"));
    scans_ = {daq::WeightScans{session->board_info(), times}, mass_kg, std::nullopt, done};
  });
  if (posted) return;
  open_->being_read_kg.reset();
  answer(kNoScans);
}

void CalibrationService::was_read(const Reading& reading, const Answer& answer) {
  open_->being_read_kg.reset();
  if (!reading) return answer(reading.error().message);
  open_->readings.push_back(*reading);
  // A reading that does not count stays in the list, for the record, but for the tare, without which nothing
  // can be judged.
  if (open_->readings.size() > 1) return answer({});
  const std::string why_not = weighed().points.front().refused;
  if (!why_not.empty()) open_->readings.clear();
  answer(why_not.empty() ? std::string{} : "the tare does not count: " + why_not);
}

std::string CalibrationService::undo() {
  if (std::string why_not = not_ready(); !why_not.empty()) return why_not;
  if (open_->readings.empty()) return "nothing has been read yet";
  open_->readings.pop_back();
  return {};
}

std::string CalibrationService::give_up() {
  if (!open_ || !open_->granted) return not_ready();
  open_.reset();
  lost_why_.clear();
  Session* const session = parts_.session();
  // Answers the request that waits for the reading.
  if (session != nullptr) {
    static_cast<void>(session->post([this](pipeline::Processor&) {
      if (scans_) end_reading(base::failure("given up"));
    }));
  }
  return {};
}

void CalibrationService::finish(const std::string& who, const io::CalibrationPaper& paper, Answer answer) {
  if (std::string why_not = not_ready(); !why_not.empty()) return answer(std::move(why_not));
  const daq::WeighedCalibration result = weighed();
  if (!result.fit.load_cell) return answer("not yet: " + result.fit.reason);
  const std::optional<daq::GainChange> change = change_of(result);
  if (change && !paper.confirms_gain) {
    daemon::CalibrationRefusal refusal{
        daq::to_text(*change) + "; nothing was kept; if the change is meant, finish with \"confirm\": true"};
    refusal.gain_change = change;
    return answer(std::move(refusal));
  }
  const auto kept =
      io::keep_result(result, paper, parts_.config.bench.calibration_folder, parts_.date_ns(), change);
  if (!kept) return answer(kept.error().message);
  parts_.events.load_cell_calibrated(kept->file, result.fit.load_cell->gain_N_per_V, who, change);
  file_ = kept->file;
  open_.reset();
  lost_why_.clear();
  use(kept->stored.facts, kept->stored.load_cell, who, answer);
}

void CalibrationService::use(const record::CalibrationFacts& facts, const daq::LoadCell& cell,
                             const std::string& who, const Answer& answer) {
  io::BenchConfig& bench = parts_.config.bench;
  bench.load_cell_gain_N_per_V = cell.gain_N_per_V;
  bench.load_cell_zero_V = cell.zero_V;
  bench.calibration = facts;
  Session* const session = parts_.session();
  // Without a session the next one begins with it. Commands are done in their order: no test can begin
  // between what was answered and this.
  const bool posted = session != nullptr && session->post([this, session, facts, cell, who,
                                                           answer](pipeline::Processor& processor) {
    const double load_N = processor.calibration().normal_load_N();
    const auto report = processor.recalibrate({session->board_info(), cell, load_N},
                                              evaluation::calibration_in_use(cell, facts), who);
    if (report.refusal.empty()) {
      parts_.storage.amend([&](record::RecordHeader& header) {
        header.load_cell = cell;
        header.calibration = facts;
      });
    }
    parts_.on_main([answer, report] { answer({}); });
  });
  if (!posted) answer({});
}

}  // namespace stickslip::runtime
