/// \file
/// Calibrates the load cell in the running daemon. Weights are read from passing scans, by the same criteria
/// and into the same files as in `stickslip calibrate`.
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
#include "daemon/types/event_receiver.hpp"

namespace stickslip::runtime {

/// Main thread, unless marked otherwise.
class CalibrationService final : public daemon::Calibrator {
 public:
  struct Parts {
    io::DaemonConfig& config;  ///< Holds the calibration in use; the next session begins with it.
    storage::Storage& storage;
    daemon::EventReceiver& events;
    std::function<Session*()> session;                   ///< Returns null while there is no session.
    std::function<void(std::function<void()>)> on_main;  ///< Runs a function on the main thread. Any thread.
    /// Date of a new calibration: wall time, ns since 1970.
    std::function<std::int64_t()> date_ns;
    /// Time that decides whether one has expired: the clock of the scans, ns since 1970.
    std::function<std::int64_t()> now_ns;
  };
  explicit CalibrationService(Parts parts) : parts_(std::move(parts)) {}

  /// Call it before the first scan of a session.
  void session_began(const SessionSettings& settings);
  /// Call it when a session has ended. A calibration under way is aborted; its readings are lost.
  void session_ended();
  /// Why no test may begin: a calibration is under way. Else nothing.
  [[nodiscard]] std::optional<std::string> why_no_test() const;

  /// Takes each block as it was read. Processing thread.
  void block(const daq::ScanBlock& block);
  /// Call it after the last block of a session. Processing thread.
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
    bool granted = false;                 ///< The processing thread has confirmed that the bench is idle.
    std::optional<double> being_read_kg;  ///< Mass of the weight being read; absent: none.
    std::vector<daq::WeightReading> readings;
  };
  /// Scans of the weight being read. Processing thread.
  struct Scans {
    daq::WeightScans scans;
    double mass_kg;
    std::optional<daq::ScanIndex> next;
    std::function<void(const Reading&)> done;
  };

  [[nodiscard]] daq::WeighedCalibration weighed() const;
  /// Of that fit against the gain in use.
  [[nodiscard]] std::optional<daq::GainChange> change_of(const daq::WeighedCalibration& result) const;
  /// Why no step of a calibration can be taken now; empty: one can.
  [[nodiscard]] std::string not_ready() const;
  void was_read(const Reading& reading, const Answer& answer);
  void use(const record::CalibrationFacts& facts, const daq::LoadCell& cell, const std::string& who,
           const Answer& answer);
  void end_reading(const Reading& reading);

  Parts parts_;
  std::optional<Open> open_;
  std::uint64_t number_ = 0;  ///< Number of the calibration under way; answers to an earlier one are ignored.
  std::string lost_why_;      ///< Why the latest calibration was aborted; empty: it was not.
  std::filesystem::path file_;
  daq::LoadCell session_load_cell_;
  record::CalibrationFacts session_facts_;
  double gravity_m_per_s2_ = 0.0;

  std::optional<Scans> scans_;  ///< Processing thread.
};

}  // namespace stickslip::runtime
