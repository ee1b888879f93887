#include <fmt/format.h>

#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/words.hpp"

namespace stickslip::record {

namespace {

constexpr const char* kForce = "coefficient";

void write_force(hid_t entry, hid_t truth, const ScanSource& scans) {
  ColumnWriter<double> column{
      truth,
      FieldName{kForce, "1", "true coefficient of the coupling at each scan of raw, without noise [1]"},
      scans.size()};
  // Rows of raw, and so with its axis.
  const GroupHandle raw = open_group(entry, "raw");
  attach_scale(column.dataset(), open_dataset(raw.get(), "time"), kForce);
  scans.for_each_force_piece([&](std::span<const double> force) { column.append(force); });
}

}  // namespace

std::vector<double> read_true_coefficient(hid_t entry, std::size_t scan_count) {
  const GroupHandle group = open_group(entry, "truth");
  if (!has(group.get(), kForce)) return {};
  return read_column<double>(group.get(), kForce, scan_count);
}

void write_truth(hid_t entry, const friction::TestTruth& truth, const ScanSource& scans) {
  const GroupHandle group = make_group(entry, "truth", "NXcollection");
  for_each_field(truth, FieldWriter{group.get()});
  write_text(group.get(), "regime", friction::name(truth.regime));

  if (truth.solver) {
    const GroupHandle solver = make_group(group.get(), "solver", "NXcollection");
    for_each_field(*truth.solver, FieldWriter{solver.get()});
  }
  if (scans.has_force() && scans.size() > 0) write_force(entry, group.get(), scans);

  TableWriter modes{make_group(group.get(), "modes", "NXcollection")};
  std::vector<double> start;
  std::vector<double> end;
  std::vector<std::string> names;
  for (const auto& mode : truth.modes) {
    start.push_back(mode.start_s);
    end.push_back(mode.end_s);
    names.emplace_back(friction::name(mode.mode));
  }
  modes.add(FieldName{"start_time", "s", "begin of the mode, after the first scan [s]"}, start);
  modes.add(FieldName{"end_time", "s", "end of the mode, after the first scan [s]"}, end);
  modes.add("mode", names);

  TableWriter cycles{make_group(group.get(), "cycles", "NXcollection")};
  for_each_true_cycle_column([&](const FieldName& name, auto member) {
    std::vector<double> column;
    for (const auto& cycle : truth.cycles) column.push_back(cycle.*member);
    cycles.add(name, column);
  });
}

friction::TestTruth read_truth(hid_t entry) {
  const GroupHandle group = open_group(entry, "truth");
  friction::TestTruth truth;
  for_each_field(truth, FieldReader{group.get()});
  const std::string regime = read_text(group.get(), "regime");
  const auto known = friction::regime_from_name(regime);
  if (!known) throw HdfError(fmt::format("truth/regime '{}' is unknown", regime));
  truth.regime = *known;

  if (has(group.get(), "solver")) {
    const GroupHandle solver = open_group(group.get(), "solver");
    for_each_field(truth.solver.emplace(), FieldReader{solver.get()});
  }

  const GroupHandle modes = open_group(group.get(), "modes");
  const auto start = read_column<double>(modes.get(), "start_time");
  const auto end = read_column<double>(modes.get(), "end_time", start.size());
  const auto names = read_texts(modes.get(), "mode");
  if (names.size() != start.size()) throw HdfError("truth/modes/mode has another length than start_time");
  for (std::size_t i = 0; i < start.size(); ++i) {
    const auto mode = mode_from_name(names[i]);
    if (!mode) throw HdfError(fmt::format("truth/modes/mode '{}' is unknown", names[i]));
    truth.modes.push_back({start[i], end[i], *mode});
  }

  const GroupHandle cycles = open_group(group.get(), "cycles");
  truth.cycles.resize(read_column<double>(cycles.get(), "onset_time").size());
  for_each_true_cycle_column([&](const FieldName& name, auto member) {
    const auto column = read_column<double>(cycles.get(), std::string{name.name}, truth.cycles.size());
    for (std::size_t i = 0; i < column.size(); ++i) truth.cycles[i].*member = column[i];
  });
  return truth;
}

}  // namespace stickslip::record
