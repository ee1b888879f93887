#include <fmt/format.h>

#include "core/record/enum_names.hpp"
#include "core/record/estimator_field.hpp"
#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"

namespace stickslip::record {
namespace {

constexpr FieldName kLevelAtEnd{"unloaded_level", "1", "coefficient of the unloaded cell after the test [1]"};
constexpr FieldName kComputeTime{"compute_time", "s", "time the evaluation took [s]"};

}  // namespace

void write_process(hid_t entry, const Record& record, const std::string& sha256) {
  const GroupHandle group = make_group(entry, "process", "NXprocess");
  const FieldWriter write{group.get()};
  for_each_field(record.header.process, write);
  write_text(group.get(), "status", name(record.end->status));
  write_texts(group.get(), "reasons", record.end->reasons);
  write(FieldName{"end_cause", "", ""}, record.end->cause);
  write(kLevelAtEnd, record.end->unloaded_level);
  write(kComputeTime, record.end->compute_time_s);
  write_text(group.get(), "sha256", sha256);
}

void read_process(hid_t entry, Record& record) {
  const GroupHandle group = open_group(entry, "process");
  const FieldReader read{group.get()};
  for_each_field(record.header.process, read);
  read_estimator_of_0_1(record.header.process);
  const std::string status = read_text(group.get(), "status");
  const auto known = status_from_name(status);
  if (!known) throw HdfError(fmt::format("process/status '{}' is unknown", status));
  record.end->status = *known;
  record.end->reasons = read_texts(group.get(), "reasons");
  read(FieldName{"end_cause", "", ""}, record.end->cause);
  read(kLevelAtEnd, record.end->unloaded_level);
  read(kComputeTime, record.end->compute_time_s);
  record.sha256 = read_text(group.get(), "sha256");
}

}  // namespace stickslip::record
