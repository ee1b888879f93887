#include <fmt/format.h>

#include <string>
#include <utility>

#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/iso_time.hpp"
#include "core/record/layout.hpp"

namespace stickslip::record {
namespace {

constexpr const char* kMetadata = "metadata";
constexpr FieldName kTestNumber{"test_number", "1", "number of the test since the program started [1]"};
constexpr FieldName kTriggerScan{"trigger_scan", "1", "scan at which the force crossed the trigger [1]"};

std::optional<std::int64_t> read_time(hid_t entry, const std::string& name) {
  if (!has(entry, name)) return std::nullopt;
  const std::string text = read_text(entry, name);
  const auto time = ns_from_iso_time(text);
  if (!time) throw HdfError(fmt::format("{} '{}' is no time of this format", name, text));
  return time;
}

void write_metadata(hid_t entry, const Metadata& metadata) {
  if (metadata.empty()) return;
  const GroupHandle group = make_group(entry, kMetadata, "NXcollection");
  for (const auto& [key, value] : metadata) write_text(group.get(), key, value);
}

Metadata read_metadata(hid_t entry) {
  if (!has(entry, kMetadata)) return {};
  const GroupHandle group = open_group(entry, kMetadata);
  Metadata metadata;
  for (const std::string& key : names_in(group.get(), kMetadata, kMostMetadata)) {
    std::string value = read_text(group.get(), key);
    if (const std::string refusal = metadata_refusal(key, value); !refusal.empty())
      throw HdfError(fmt::format("{}: {}", kMetadata, refusal));
    metadata.emplace(key, std::move(value));
  }
  return metadata;
}

}  // namespace

void write_identity(hid_t entry, const Record& record, const ScanSource& scans) {
  const RecordHeader& header = record.header;
  const FieldWriter write{entry};
  write(FieldName{"title", "", ""}, header.title);
  write(FieldName{"entry_identifier_uuid", "", ""}, header.uuid);
  write(kTestNumber, header.test_number);
  write(kTriggerScan, header.trigger_scan);
  if (header.start_realtime_ns) write_text(entry, "start_time", iso_time(*header.start_realtime_ns));
  if (record.end->end_realtime_ns) write_text(entry, "end_time", iso_time(*record.end->end_realtime_ns));
  write_metadata(entry, header.sample.metadata);
  if (scans.size() > 0) {
    write_scalar(entry, {"collection_time", "s", "duration of the record [s]"},
                 static_cast<double>(scans.extent()) / header.board.scan_rate_granted_Hz);
  }
}

void read_identity(hid_t entry, Record& record) {
  RecordHeader& header = record.header;
  const FieldReader read{entry};
  read(FieldName{"title", "", ""}, header.title);
  read(FieldName{"entry_identifier_uuid", "", ""}, header.uuid);
  read(kTestNumber, header.test_number);
  read(kTriggerScan, header.trigger_scan);
  header.start_realtime_ns = read_time(entry, "start_time");
  record.end->end_realtime_ns = read_time(entry, "end_time");
  header.sample.metadata = read_metadata(entry);
}

}  // namespace stickslip::record
