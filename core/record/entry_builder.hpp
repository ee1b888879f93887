/// \file
/// Encodes the entries of a journal as bytes, each ready for one write().
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "core/record/journal_format.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// Encoder of one journal's entries. Returned bytes include head and CRC and are valid until the next call.
/// Ranges are not checked: read_journal() takes scans, gaps, anchors and events outside of those of
/// range_checked() for damage.
class EntryBuilder {
 public:
  using Bytes = std::span<const std::byte>;

  /// \param header  has a uuid, and a load cell if the board gives counts (contract).
  explicit EntryBuilder(const RecordHeader& header);

  /// The first entry. \param header  that of the constructor, which is not checked.
  [[nodiscard]] Bytes header(const RecordHeader& header);
  /// \param first  not before the end of the scans of the latest call (contract).
  /// \param raw  consecutive, not empty; counts are whole numbers in 0 … maxdata (contract).
  /// \param stamp  only its monotonic time is stored.
  [[nodiscard]] Bytes scans(daq::ScanIndex first, std::span<const double> raw, const daq::ClockStamp& stamp);
  /// Noise-free coefficients of consecutive scans that are in the journal already; NaN where unknown.
  /// \param first  of scans that no earlier call had; read_journal() takes an overlap, or values of which no
  ///        scan is in the journal, for damage.
  [[nodiscard]] Bytes true_coefficients(daq::ScanIndex first, std::span<const double> coefficient);
  /// Codes of the second channel. Otherwise as true_coefficients().
  /// \param codes  −1 (none came) … maxdata of the header's board.second; read_journal() takes others, and
  ///        any without board.second, for damage.
  [[nodiscard]] Bytes second(daq::ScanIndex first, std::span<const std::int32_t> codes);
  [[nodiscard]] Bytes spikes(std::span<const daq::ScanIndex> spikes);
  [[nodiscard]] Bytes gap(const daq::Gap& gap);
  [[nodiscard]] Bytes cycle(const detect::Cycle& cycle);
  [[nodiscard]] Bytes anchor(const ClockAnchor& anchor);
  [[nodiscard]] Bytes event(const Event& event);
  [[nodiscard]] Bytes end(const EndRecord& end);

 private:
  void begin();
  [[nodiscard]] Bytes finish(EntryType type, Encoding encoding, daq::ScanIndex first_scan,
                             std::int64_t time_ns);
  [[nodiscard]] Bytes text(EntryType type, daq::ScanIndex first_scan, std::string_view json);

  Encoding encoding_;
  double maxdata_;
  daq::ScanIndex next_scan_ = std::numeric_limits<daq::ScanIndex>::min();
  std::vector<std::byte> entry_;  ///< Room for the head, then the payload; reused.
};

}  // namespace stickslip::record
