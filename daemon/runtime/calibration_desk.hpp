/// \file
/// The calibration of the load cell through the running daemon: weights are read from the scans as they go
/// by, by the same judgement and into the same files as `stickslip calibrate`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "io/config.hpp"

#include "daemon/runtime/session.hpp"
#include "daemon/storage/storage.hpp"
#include "daemon/types/calibrator.hpp"

namespace stickslip::runtime {

/// Main thread, but for what is marked.
class CalibrationDesk final : public daemon::Calibrator {
 public:
  struct Parts {
    io::DaemonConfig& config;  ///< The calibration in use stands there, for the next session as well.
    storage::Storage& storage;
    std::function<Session*()> session;                   ///< Null while there is none.
    std::function<void(std::function<void()>)> on_main;  ///< From any thread: to the main thread.
    std::function<std::int64_t()> date_ns;               ///< Of a new one: people's time.
    std::function<std::int64_t()> now_ns;                ///< By which one expires: that of the scans.
  };
  explicit CalibrationDesk(Parts parts) : parts_(std::move(parts)) {}

  /// Before its first scan.
  void session_began(const SessionSettings& settings);
  /// A calibration that was under way is over, and what was read is lost.
  void session_ended();
  /// Why no test may begin, if so.
  [[nodiscard]] std::optional<std::string> why_no_test() const;

  /// Processing thread: each block as it was read.
  void block(const daq::ScanBlock& block);
  /// Processing thread: no more blocks in this session.
  void blocks_ended();

  [[nodiscard]] daemon::CalibrationView view() const override;
  void begin(const std::string& who, const daq::WeighingTimes& times, Answer answer) override;
  void weigh(double mass_kg, Answer answer) override;
  [[nodiscard]] std::string undo() override;
  void finish(const std::string& who, const io::CalibrationPaper& paper, Answer answer) override;
  [[nodiscard]] std::string give_up() override;

 private:
  using Reading = base::Result<daq::WeightReading>;
  struct Open {
    std::string who;
    daq::WeighingTimes times;
    bool granted = false;                 ///< The processing thread has said that the bench is idle.
    std::optional<double> being_read_kg;  ///< Its answer is waited for.
    std::vector<daq::WeightReading> readings;
  };
  /// Processing thread: of the weight that is being read.
  struct Scans {
    daq::WeightScans scans;
    double mass_kg;
    std::optional<daq::ScanIndex> next;
    std::function<void(const Reading&)> done;
  };

  [[nodiscard]] daq::WeighedCalibration weighed() const;
  /// Why nothing can be done with the one under way; empty: it can.
  [[nodiscard]] std::string not_ready() const;
  void was_read(const Reading& reading, const Answer& answer);
  void use(const record::CalibrationFacts& facts, const daq::LoadCell& cell, const std::string& who,
           const Answer& answer);
  void end_reading(const Reading& reading);

  Parts parts_;
  std::optional<Open> open_;
  std::uint64_t number_ = 0;  ///< Of the one under way: answers for an earlier one come too late.
  std::string lost_why_;      ///< Of the one that was under way last.
  std::filesystem::path file_;
  daq::LoadCell session_load_cell_;
  record::CalibrationFacts session_facts_;
  double gravity_m_per_s2_ = 0.0;

  std::optional<Scans> scans_;  ///< Processing thread.
};

}  // namespace stickslip::runtime
