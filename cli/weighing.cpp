#include "cli/weighing.hpp"

#include <chrono>
#include <utility>

#include "io/config.hpp"

namespace stickslip::cli {
namespace {

constexpr std::chrono::milliseconds kWeighingReadTimeout{100};
/// So long without a scan, and the board is taken for dead.
constexpr int kMostTimeouts = 50;

}  // namespace

base::Result<WeighingPlace> load_weighing_place(const std::filesystem::path& config) {
  base::Result<base::Settings> settings = base::Settings::load(config);
  if (!settings) return tl::unexpected(settings.error());
  WeighingPlace place;
  const std::filesystem::path folder = config.parent_path();
  base::Settings tester = settings->table("tester");
  if (tester.has("calibration")) {
    place.folder = folder / tester.text("calibration", "");
    // It may not exist yet, and the gain is what is sought.
    if (auto removed = settings->remove("tester.calibration", "calibrate"); !removed) {
      return tl::unexpected(removed.error());
    }
  }
  place.load_cell_gain_N_per_V =
      tester.quantity_if_given("load_cell_gain", base::Dimension::kForcePerVoltage, base::Limits::any());
  if (auto set = settings->set("tester.load_cell_gain", "\"1 N/V\"", "calibrate"); !set) {
    return tl::unexpected(set.error());
  }
  const base::Result<io::DaemonConfig> read = io::read_config(*settings, folder);
  if (!read) return tl::unexpected(read.error());
  place.board = read->board;
  place.clock_speed = read->clock_speed;
  place.gravity_m_per_s2 = read->bench.tester({}).gravity_m_per_s2;
  return place;
}

Weighing::Weighing(std::unique_ptr<base::Clock> clock, drivers::OpenedBoard board)
    : clock_(std::move(clock)), board_(std::move(board)) {}

base::Result<Weighing> Weighing::open(const WeighingPlace& place) {
  auto clock = base::make_system_clock(place.clock_speed);
  auto board = drivers::open_board(place.board, *clock);
  if (!board) return tl::unexpected(board.error());
  const daq::RawQuantity quantity = board->board->info().quantity;
  if (quantity != daq::RawQuantity::kCounts && quantity != daq::RawQuantity::kVolts) {
    return base::usage_error("{}: gives neither counts nor volts: there is no load cell to calibrate",
                             board->board->info().device);
  }
  return Weighing{std::move(clock), *std::move(board)};
}

double Weighing::span_V() const { return board().range_max_V - board().range_min_V; }

base::Result<daq::WeightReading> Weighing::read(double mass_kg, const daq::WeighingTimes& times) {
  daq::Board& board = *board_.board;
  daq::WeightScans scans{board.info(), times};
  if (auto started = board.start(); !started) return tl::unexpected(started.error());
  int timeouts = 0;
  daq::ScanBlock block;
  while (!scans.full()) {
    const daq::ReadStatus status = board.read(block, kWeighingReadTimeout);
    if (status == daq::ReadStatus::kTimeout && ++timeouts < kMostTimeouts) continue;
    if (status != daq::ReadStatus::kScans) {
      board.stop();
      const std::string why = board.last_error();
      return base::failure("the board gave {} of {} scans{}{}", scans.count(), scans.wanted(),
                           why.empty() ? "" : ": ", why);
    }
    timeouts = 0;
    rest_.insert(rest_.end(), block.scans().begin(), block.scans().end());
    // What is left belongs to the time in which the next weight settles.
    while (!rest_.empty() && !scans.full()) {
      scans.add(rest_.front());
      rest_.pop_front();
    }
  }
  board.stop();
  return scans.reading(mass_kg);
}

}  // namespace stickslip::cli
