/// \file
/// A bench that does what it is told, on paper.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/types/bench.hpp"

namespace stickslip::daemon {

inline Status some_status() {
  Status status;
  status.state = "acquiring";
  status.scan_count = 42;
  status.board.emplace();
  status.board->scan_rate_granted_Hz = 350.0;
  status.latest_test.emplace();
  status.latest_test->number = 7;
  status.latest_test->file = "/records/20261121T125252Z-0007.h5";
  status.latest_test->results.mu_s = analysis::Estimate::of(0.35);
  status.latest_test->results.mu_k = analysis::Estimate::none("no slip");
  status.bench = pipeline::BenchState::kRunning;
  status.live.emplace();
  status.live->phase = detect::Phase::kCycles;
  status.live->regime = model::Regime::kStickSlip;
  status.live->latest.emplace();
  status.live->latest->S = 0.36;
  status.storage.kind = StorageState::Kind::kShort;
  status.storage.room_h = 0.1;
  status.storage.why = "room for 6 min of tests, 10 are wanted";
  return status;
}

/// Grants everything and writes down what it was asked.
class PaperCalibrator final : public Calibrator {
 public:
  [[nodiscard]] CalibrationView view() const override {
    CalibrationView view;
    view.load_cell = {2.0, 0.0123};
    if (under_way) view.session.emplace();
    return view;
  }
  void begin(const std::string& who, const daq::WeighingTimes& times, Answer answer) override {
    asked.push_back(fmt::format("{} begins {} {}", who, times.settle_s, times.reading_s));
    under_way = true;
    answer({});
  }
  void weigh(double mass_kg, Answer answer) override {
    asked.push_back(fmt::format("weigh {}", mass_kg));
    answer({});
  }
  [[nodiscard]] std::string undo() override { return "nothing has been read yet"; }
  void finish(const std::string& who, const io::CalibrationPaper& paper, Answer answer) override {
    if (gain_change && !paper.confirms_gain) {
      CalibrationRefusal refusal{"the gain has changed"};
      refusal.gain_change = gain_change;
      return answer(std::move(refusal));
    }
    asked.push_back(fmt::format("{} finishes {} {}{}", who, paper.certificate, paper.valid_days,
                                paper.confirms_gain ? " confirmed" : ""));
    under_way = false;
    answer({});
  }
  [[nodiscard]] std::string give_up() override {
    under_way = false;
    return {};
  }

  bool under_way = false;                      ///< Between begin() and finish() or give_up().
  std::optional<daq::GainChange> gain_change;  ///< That of finish().
  std::vector<std::string> asked;
};

/// The book alone, without a journal.
class PaperBatches final : public Batches {
 public:
  [[nodiscard]] const BatchBook& book() override { return book_; }
  [[nodiscard]] std::optional<BatchProgress> progress() const override {
    const Batch* const batch = book_.current();
    if (batch == nullptr) return std::nullopt;
    return BatchProgress{
        batch->id, batch->plan.sample.name, 0, std::ssize(steps(batch->plan)), book_.next_step(*batch, {}),
        {}};
  }
  [[nodiscard]] std::string name_of(const std::filesystem::path& record) const override {
    return record.filename().string();
  }
  void begin(BatchPlan plan, std::string who, Answer answer) override {
    const std::size_t second = 1 + book_.batches().size();
    happens(who, BatchBegun{fmt::format("20261122T18030{}Z", second), std::move(plan)}, answer);
  }
  void end(std::string who, Answer answer) override {
    if (book_.current() == nullptr) {
      answer(tl::unexpected(base::Error{base::ErrorKind::kBusy, "there is no batch"}));
      return;
    }
    happens(who, BatchEnded{book_.current()->id}, answer);
  }
  void void_test(const std::string& record, std::string reason, std::string who, Answer answer) override {
    happens(who, TestVoided{record, std::move(reason)}, answer);
  }
  void restore(const std::string& record, std::string who, Answer answer) override {
    if (book_.voided(record) == nullptr) {
      answer(tl::unexpected(base::Error{base::ErrorKind::kBusy, record + " is not void"}));
      return;
    }
    happens(who, TestRestored{record}, answer);
  }

 private:
  template <typename What>
  void happens(const std::string& who, What what, const Answer& answer) {
    book_.apply({"2026-11-22T18:03:01+00:00", who, std::move(what)});
    answer({});
  }

  BatchBook book_;
};

/// Says what it was asked for; in JSON, as the real one does, where JSON is the form.
class PaperReports final : public Reports {
 public:
  void make(std::span<const ReportedBatch> batches, ReportForm form, std::string_view pool,
            Answer answer) override {
    std::string text = fmt::format("form {}:", static_cast<int>(form));
    for (const ReportedBatch& batch : batches) text += fmt::format(" {} {}", batch.id, batch.label);
    if (!pool.empty()) text += fmt::format(" pool {}", pool);
    if (refusal) return answer(tl::unexpected(*refusal));
    answer(form == ReportForm::kJson ? fmt::format("\"{}\"", text) : std::move(text));
  }

  void trace(const TraceRequest& request, Answer answer) override {
    if (refusal) return answer(tl::unexpected(*refusal));
    answer(fmt::format("\"trace {} {} {} {}\"", request.record.string(), request.points,
                       request.from_s.value_or(-1.0), request.to_s.value_or(-1.0)));
  }

  void report(const std::filesystem::path& record, ReportForm form, Answer answer) override {
    if (refusal) return answer(tl::unexpected(*refusal));
    answer(fmt::format("\"form {}: {}\"", static_cast<int>(form), record.string()));
  }
  void find(const RecordSearch& search, Answer answer) override {
    if (refusal) return answer(tl::unexpected(*refusal));
    std::string text = fmt::format("most {}", search.most);
    for (const auto& [option, value] : search.conditions) text += fmt::format(" {}={}", option, value);
    answer(fmt::format("\"{}\"", text));
  }
  /// Holds one.
  [[nodiscard]] base::Result<std::filesystem::path> record(const std::string& name) const override {
    if (name == "2026/old one.h5") return std::filesystem::path{"/records/" + name};
    return base::usage_error("there is no record {}", name);
  }

  std::optional<base::Error> refusal;
};

class PaperBench final : public Bench {
 public:
  [[nodiscard]] Status status() const override { return some_status(); }
  [[nodiscard]] std::vector<TestSummary> tests() const override { return {*some_status().latest_test}; }
  [[nodiscard]] Plan plan() const override { return plan_; }
  void set_plan(Plan plan) override { plan_ = std::move(plan); }
  [[nodiscard]] Batches& batches() override { return batches_; }
  [[nodiscard]] Reports& reports() override { return reported; }
  void trend(std::function<void(std::string)> answer) override { answer(R"({"charts": []})"); }
  void command(Command command, std::function<void(const Outcome&)> answer) override {
    commands.push_back(command);
    if (later) {
      waiting = [answer, refusal = refusal] { answer(outcome(refusal)); };
    } else {
      answer(outcome(refusal));
    }
  }
  [[nodiscard]] Calibrator& calibrator() override { return calibrations; }
  static Outcome outcome(const std::string& refusal) {
    Outcome outcome;
    outcome.report.refusal = refusal;
    outcome.report.state = pipeline::BenchState::kLoading;
    outcome.report.test = 8;
    outcome.report.scan = 1234;
    return outcome;
  }

  PaperCalibrator calibrations;
  PaperReports reported;
  std::vector<Command> commands;
  std::string refusal;
  bool later = false;
  std::function<void()> waiting;

 private:
  Plan plan_;
  PaperBatches batches_;
};

}  // namespace stickslip::daemon
