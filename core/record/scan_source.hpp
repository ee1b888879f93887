/// \file
/// Source of a record's scans, piece by piece, from memory or a file. Files are thus built and verified in
/// constant memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "core/base/long_column.hpp"
#include "core/base/scan_index.hpp"
#include "core/record/record.hpp"

namespace stickslip::record {

/// Rows of a record's scans that follow each other: columns of equal length. scan rises strictly; raw is in
/// board.quantity. Valid during the call that it is passed to.
struct ScanPiece {
  std::span<const base::ScanIndex> scan;
  std::span<const double> raw;
};

/// The scans of one record, which can be read from first to last any number of times, with equal results.
/// Functions of a source that reads a file may throw std::exception.
class ScanSource {
 public:
  /// Rows of each piece but the last, which may have fewer: 100 s at 350 scans/s, and a chunk of the file.
  static constexpr std::size_t kPiece = 35'000;

  virtual ~ScanSource() = default;

  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Scan periods from the first scan to the end of the last, gaps included; 0 if there is no scan.
  [[nodiscard]] virtual std::int64_t extent() const = 0;
  /// Calls `use` with each piece in order; not at all if there is no scan.
  virtual void for_each_piece(const std::function<void(const ScanPiece&)>& use) const = 0;
  /// Whether the noise-free force is available.
  [[nodiscard]] virtual bool has_force() const = 0;
  /// Requires has_force(). Coefficients, as many as scans, in pieces of the same lengths; NaN where unknown.
  virtual void for_each_force_piece(const std::function<void(std::span<const double>)>& use) const = 0;
  /// Whether codes of a second channel are available.
  [[nodiscard]] virtual bool has_second() const = 0;
  /// Requires has_second(). As many codes as scans, in pieces of the same lengths;
  /// daq::SecondChannel::kNoCode where none came.
  virtual void for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const = 0;
};

/// Source on a record in memory, which must outlive it.
class RecordScans final : public ScanSource {
 public:
  explicit RecordScans(const Record& record) : record_(record) {}

  [[nodiscard]] std::size_t size() const override { return record_.scan.size(); }
  [[nodiscard]] std::int64_t extent() const override {
    return record_.scan.empty() ? 0 : record_.scan.back() - record_.scan.front() + 1;
  }
  void for_each_piece(const std::function<void(const ScanPiece&)>& use) const override;
  [[nodiscard]] bool has_force() const override { return !record_.true_coefficient.empty(); }
  void for_each_force_piece(const std::function<void(std::span<const double>)>& use) const override;
  [[nodiscard]] bool has_second() const override { return !record_.second.empty(); }
  void for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const override;

 private:
  const Record& record_;
};

/// Scans as columns of equal length; `second` may be empty. Thread-bound.
struct ScanColumns {
  /// \param folder  of files for what exceeds a few blocks; empty: all in memory (base::LongColumn).
  explicit ScanColumns(const std::filesystem::path& folder = {})
      : scan(folder), raw(folder), second(folder) {}

  /// The same columns, to be read in another thread while these are read here. Neither may grow.
  [[nodiscard]] ScanColumns view() const {
    ScanColumns view;
    view.scan = scan.view();
    view.raw = raw.view();
    view.second = second.view();
    return view;
  }

  base::LongColumn<base::ScanIndex> scan;
  base::LongColumn<double> raw;
  base::LongColumn<std::int32_t> second;
};

/// Source on a range of rows of columns. It has no noise-free force.
class ColumnScans final : public ScanSource {
 public:
  /// The rows [first, first + count), which must exist; the columns no longer change.
  ColumnScans(std::shared_ptr<const ScanColumns> columns, std::size_t first, std::size_t count);

  /// The same scans, to be read in another thread while these are read here.
  [[nodiscard]] ColumnScans view() const {
    return {std::make_shared<const ScanColumns>(columns_->view()), first_, count_};
  }

  [[nodiscard]] std::size_t size() const override { return count_; }
  [[nodiscard]] std::int64_t extent() const override;
  void for_each_piece(const std::function<void(const ScanPiece&)>& use) const override;
  [[nodiscard]] bool has_force() const override { return false; }
  void for_each_force_piece(const std::function<void(std::span<const double>)>& use) const override;
  [[nodiscard]] bool has_second() const override { return !columns_->second.empty(); }
  void for_each_second_piece(const std::function<void(std::span<const std::int32_t>)>& use) const override;

 private:
  std::shared_ptr<const ScanColumns> columns_;
  std::size_t first_;
  std::size_t count_;
};

}  // namespace stickslip::record
