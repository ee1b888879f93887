#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/record/enum_names.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/long_tables.hpp"

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

const FieldName kModeStart{"start_time", "s", "begin of the mode, after the first scan [s]"};
const FieldName kModeEnd{"end_time", "s", "end of the mode, after the first scan [s]"};
constexpr const char* kModeName = "mode";

void write_modes(hid_t truth, const base::LongColumn<model::ModeInterval>& modes) {
  TableWriter table{make_group(truth, "modes", "NXcollection")};
  static_cast<void>(write_member(table, kModeStart, modes, &model::ModeInterval::start_s));
  static_cast<void>(write_member(table, kModeEnd, modes, &model::ModeInterval::end_s));
  std::size_t width = 1;
  for (const model::ModeInterval& mode : modes) {
    width = std::max(width, std::string_view{model::name(mode.mode)}.size());
  }
  TextColumnWriter names = table.add_empty_texts(kModeName, width, modes.size());
  write_rows(names, modes,
             [](const model::ModeInterval& mode) { return std::string_view{model::name(mode.mode)}; });
}

template <typename Use>
void for_each_mode(hid_t truth, const Use& use) {
  const GroupHandle group = open_group(truth, "modes");
  const DatasetHandle names = open_dataset(group.get(), kModeName);
  for_each_row<model::ModeInterval>(
      group.get(), std::string{kModeStart.name},
      [&](std::size_t first, std::vector<model::ModeInterval>& rows, std::size_t count) {
        read_member(group.get(), kModeStart, &model::ModeInterval::start_s, count, first, rows);
        read_member(group.get(), kModeEnd, &model::ModeInterval::end_s, count, first, rows);
        if (row_count(group.get(), kModeName) != count) {
          throw HdfError("truth/modes/mode has another length than start_time");
        }
        if (rows.empty()) return;
        const std::vector<std::string> texts = read_text_rows(names, kModeName, first, rows.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
          const auto mode = mode_from_name(texts[i]);
          if (!mode) throw HdfError(fmt::format("truth/modes/mode '{}' is unknown", texts[i]));
          rows[i].mode = *mode;
        }
      },
      use);
}

template <typename Use>
void for_each_true_cycle(hid_t truth, const Use& use) {
  const GroupHandle group = open_group(truth, "cycles");
  for_each_row<model::TrueCycle>(
      group.get(), "onset_time",
      [&](std::size_t first, std::vector<model::TrueCycle>& rows, std::size_t count) {
        for_each_true_cycle_column([&](const FieldName& name, auto member) {
          read_member(group.get(), name, member, count, first, rows);
        });
      },
      use);
}

model::TestTruth facts_in(hid_t group) {
  model::TestTruth truth;
  for_each_field(truth, FieldReader{group});
  const std::string regime = read_text(group, "regime");
  const auto known = model::regime_from_name(regime);
  if (!known) throw HdfError(fmt::format("truth/regime '{}' is unknown", regime));
  truth.regime = *known;

  if (has(group, "solver")) {
    const GroupHandle solver = open_group(group, "solver");
    for_each_field(truth.solver.emplace(), FieldReader{solver.get()});
  }
  return truth;
}

}  // namespace

std::vector<double> read_true_coefficient(hid_t entry, std::size_t scan_count) {
  const GroupHandle group = open_group(entry, "truth");
  if (!has(group.get(), kForce)) return {};
  return read_column<double>(group.get(), kForce, scan_count);
}

void write_truth(hid_t entry, const model::TestTruth& truth, const ScanSource& scans) {
  const GroupHandle group = make_group(entry, "truth", "NXcollection");
  for_each_field(truth, FieldWriter{group.get()});
  write_text(group.get(), "regime", model::name(truth.regime));

  if (truth.solver) {
    const GroupHandle solver = make_group(group.get(), "solver", "NXcollection");
    for_each_field(*truth.solver, FieldWriter{solver.get()});
  }
  if (scans.has_force() && scans.size() > 0) write_force(entry, group.get(), scans);

  write_modes(group.get(), truth.modes);
  TableWriter cycles{make_group(group.get(), "cycles", "NXcollection")};
  for_each_true_cycle_column([&](const FieldName& name, auto member) {
    static_cast<void>(write_member(cycles, name, truth.cycles, member));
  });
}

model::TestTruth read_truth_facts(hid_t entry) { return facts_in(open_group(entry, "truth").get()); }

model::TestTruth read_truth(hid_t entry) {
  const GroupHandle group = open_group(entry, "truth");
  model::TestTruth truth = facts_in(group.get());
  for_each_mode(group.get(), [&](const model::ModeInterval& mode) { truth.modes.push_back(mode); });
  for_each_true_cycle(group.get(), [&](const model::TrueCycle& cycle) { truth.cycles.push_back(cycle); });
  return truth;
}

void check_truth(hid_t entry) {
  const GroupHandle group = open_group(entry, "truth");
  static_cast<void>(facts_in(group.get()));
  for_each_mode(group.get(), [](const model::ModeInterval&) {});
  for_each_true_cycle(group.get(), [](const model::TrueCycle&) {});
}

}  // namespace stickslip::record
