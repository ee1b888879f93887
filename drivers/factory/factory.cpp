#include "drivers/factory/factory.hpp"

#include <algorithm>
#include <utility>

#include "core/record/read_apart.hpp"
#include "drivers/replay/replay_board.hpp"

namespace stickslip::drivers {
namespace {

base::Result<OpenedBoard> open_simulated(SimulatedBoardSettings settings, base::Clock& clock,
                                         const daq::Predecessor& before) {
  settings.continues = before.continuation;
  base::Result<SimulatedTester> simulated = make_simulated_tester(settings, clock);
  if (!simulated) return tl::unexpected(simulated.error());
  return OpenedBoard{std::move(simulated->board),
                     std::move(simulated->truth),
                     simulated->load_cell,
                     simulated->tester,
                     {},
                     nullptr,
                     {}};
}

base::Result<OpenedBoard> open_replay(const std::filesystem::path& file, base::Clock& clock) {
  base::Result<record::Record> record = record::read_record_apart(file);
  if (!record) return tl::unexpected(record.error());
  const std::optional<daq::LoadCell> load_cell = record->header.load_cell;
  const model::Tester tester = record->header.tester.tester();
  std::string characterisation = record->header.process.characterisation;
  record::CalibrationFacts calibration = record->header.calibration;
  std::string kept = record->header.process.kept;
  std::string estimator = record->header.process.estimator;
  auto recorded = std::make_shared<daq::RecordedFacts>(
      daq::RecordedFacts{std::move(record->anchors),
                         std::move(record->gaps),
                         nullptr,
                         record->end ? record->end->read_latency : std::nullopt,
                         {}});
  recorded->unloaded_level = record->header.plan.unloaded_level;
  if (auto& check = record->header.self_check) {
    recorded->self_check = std::make_shared<const daq::SelfCheck>(*std::move(check));
  }
  for (const record::Event& event : record->events) {
    if (auto note = daq::parse_note(event.scan, event.text)) recorded->notes.push_back(*std::move(note));
  }
  std::stable_sort(recorded->notes.begin(), recorded->notes.end(),
                   [](const daq::Note& a, const daq::Note& b) { return a.scan < b.scan; });
  Replay replay = make_replay(std::move(*record), clock);
  return OpenedBoard{std::move(replay.board),
                     std::move(replay.truth),
                     load_cell,
                     tester,
                     std::move(characterisation),
                     std::move(recorded),
                     std::move(calibration),
                     std::move(kept),
                     std::move(estimator)};
}

base::Result<OpenedBoard> open_comedi(ComediBoardSettings settings, base::Clock& clock,
                                      const daq::Predecessor& before) {
  settings.continues = before.continuation;
  settings.before = before.board;
  base::Result<std::unique_ptr<daq::Board>> board = make_comedi_board(settings, clock);
  if (!board) return tl::unexpected(board.error());
  return OpenedBoard{std::move(*board), nullptr, std::nullopt, std::nullopt, {}, nullptr, {}};
}

}  // namespace

base::Result<OpenedBoard> open_board(const BoardConfig& config, base::Clock& clock,
                                     const daq::Predecessor& before) {
  switch (config.driver) {
    case Driver::kSimulated:
      return open_simulated(config.simulated, clock, before);
    case Driver::kReplay:
      return open_replay(config.replay_file, clock);
    case Driver::kComedi:
      return open_comedi(config.comedi, clock, before);
  }
  return base::usage_error("no such driver");
}

base::Result<void> check_board(const BoardConfig& config) {
  if (config.driver == Driver::kComedi) return {};
  const std::unique_ptr<base::Clock> clock = base::make_system_clock();
  const base::Result<OpenedBoard> opened = open_board(config, *clock);
  if (!opened) return tl::unexpected(opened.error());
  return {};
}

}  // namespace stickslip::drivers
