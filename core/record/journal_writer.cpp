#include "core/record/journal.hpp"

namespace stickslip::record {

base::Result<JournalWriter> JournalWriter::create(const std::filesystem::path& path, RecordHeader header,
                                                  const FileCalls& calls) {
  if (header.uuid.empty()) header.uuid = make_uuid();
  EntryBuilder builder{header};
  auto file = JournalFile::create(path, builder.header(header), calls);
  if (!file) return tl::unexpected(file.error());
  return JournalWriter{*std::move(file), std::move(builder)};
}

base::Result<void> JournalWriter::append_scans(daq::ScanIndex first, std::span<const double> raw,
                                               const daq::ClockStamp& stamp) {
  // Refused scans may come again: the order is checked against those that were written.
  EntryBuilder builder = builder_;
  auto appended = file_.append(builder.scans(first, raw, stamp));
  if (appended) builder_ = std::move(builder);
  return appended;
}

base::Result<void> JournalWriter::append_true_coefficients(daq::ScanIndex first,
                                                           std::span<const double> coefficient) {
  return file_.append(builder_.true_coefficients(first, coefficient));
}

base::Result<void> JournalWriter::append_second(daq::ScanIndex first, std::span<const std::int32_t> codes) {
  return file_.append(builder_.second(first, codes));
}

base::Result<void> JournalWriter::append_spikes(std::span<const daq::ScanIndex> spikes) {
  return file_.append(builder_.spikes(spikes));
}

base::Result<void> JournalWriter::append_gap(const daq::Gap& gap) { return file_.append(builder_.gap(gap)); }

base::Result<void> JournalWriter::append_cycle(const detect::Cycle& cycle) {
  return file_.append(builder_.cycle(cycle));
}

base::Result<void> JournalWriter::append_anchor(const ClockAnchor& anchor) {
  return file_.append(builder_.anchor(anchor));
}

base::Result<void> JournalWriter::append_event(const Event& event) {
  return file_.append(builder_.event(event));
}

base::Result<void> JournalWriter::append_end(const EndRecord& end) { return file_.append(builder_.end(end)); }

base::Result<void> JournalWriter::sync() { return file_.sync(); }

}  // namespace stickslip::record
