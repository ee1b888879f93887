/// \file
/// A vector for one value per scan or one row per slip that may grow beyond memory.
///
///     LongColumn<double> force{folder};
///     force.push_back(0.3);
///     for (const double value : std::as_const(force)) …
///
/// Without a folder it is a vector in blocks. With a folder, kResident blocks stay in memory, the last one
/// and those fetched latest; the others are read from an unnamed file there, which is made when it is needed.
/// Sequential or local access reads each block once.
#pragma once

#include <algorithm>
#include <bit>
#include <compare>
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/contract.hpp"
#include "core/base/scratch_file.hpp"

namespace stickslip::base {

/// Vector that may keep its elements in a file. Thread-bound, even if const; view() makes a column for
/// another thread. With a folder, growing, truncating and reading may throw std::system_error; the column can
/// be moved but not copied, and its elements cannot be changed (contract). It must then be read as const, for
/// example by std::as_const, since the non-const [] and iterators give references. A column that was moved
/// from can only be assigned to or destroyed.
template <typename T>
class LongColumn {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Elements of a block: for numbers of at most 8 bytes 3 min at 350 scans/s; for rows of a table, which are
  /// fewer, at most 32 kB.
  static constexpr std::size_t kBlock = sizeof(T) <= sizeof(double)
                                            ? std::size_t{1} << 16U
                                            : std::bit_floor((std::size_t{1} << 15U) / sizeof(T));
  static constexpr std::size_t kResident = 4;  ///< Most blocks in memory if there is a folder.

  template <bool kConst>
  class Iterator;
  using value_type = T;
  using iterator = Iterator<false>;
  using const_iterator = Iterator<true>;

  LongColumn() = default;
  LongColumn(const std::vector<T>& values) {  // NOLINT(google-explicit-constructor): it is such a vector.
    for (const T& value : values) push_back(value);
  }
  LongColumn(std::initializer_list<T> values) {
    for (const T& value : values) push_back(value);
  }
  /// \param folder  of the file; empty: all in memory.
  explicit LongColumn(std::filesystem::path folder) : folder_(std::move(folder)) {}
  LongColumn(const LongColumn& other) { *this = other; }
  LongColumn(LongColumn&&) noexcept = default;
  LongColumn& operator=(const LongColumn& other) {
    if (this == &other) return *this;
    STICKSLIP_EXPECTS(other.folder_.empty());
    LongColumn copy;
    for (std::size_t k = 0; k < other.size_; ++k) copy.push_back(other[k]);
    return *this = std::move(copy);
  }
  LongColumn& operator=(LongColumn&&) noexcept = default;
  ~LongColumn() = default;

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }

  void push_back(const T& value) {
    if (size_ % kBlock == 0) add_block();
    blocks_.back()[size_ % kBlock] = value;
    ++size_;
  }
  /// Keeps the first `size` elements. If it throws, the column can only be assigned to or destroyed.
  /// \param size  at most size() (contract).
  void truncate(std::size_t size) {
    STICKSLIP_EXPECTS(size <= size_);
    const std::size_t blocks = (size + kBlock - 1) / kBlock;
    if (blocks < blocks_.size()) {
      std::erase_if(resident_, [&](std::size_t block) { return block >= blocks; });
      blocks_.resize(blocks);
      // The last block is in memory, since it may grow.
      if (blocks > 0 && blocks_.back() == nullptr) fetch(blocks - 1);
    }
    size_ = size;
  }
  void pop_back() { truncate(size_ - 1); }
  /// The same elements, to be read in another thread while this column is read here. Neither may grow or be
  /// written; either may be replaced or destroyed.
  [[nodiscard]] LongColumn view() const {
    LongColumn view{folder_};
    view.size_ = size_;
    view.blocks_ = blocks_;
    view.file_ = file_;
    if (file_ && !blocks_.empty()) {
      // Buffers of blocks that lie in the file are used again; each thread has its own.
      std::fill(view.blocks_.begin(), view.blocks_.end() - 1, nullptr);
      view.resident_ = {blocks_.size() - 1};
    }
    return view;
  }
  /// Removes all elements and the folder: what is added later stays in memory.
  void clear() { *this = LongColumn{}; }
  /// Replaces all elements by `count` of this value; removes the folder.
  void assign(std::size_t count, T value) {
    clear();
    while (size_ < count) push_back(value);
  }

  [[nodiscard]] T operator[](std::size_t k) const {
    const T* block = blocks_[k / kBlock].get();
    if (block == nullptr) block = fetch(k / kBlock);
    return block[k % kBlock];
  }
  [[nodiscard]] T& operator[](std::size_t k) {
    STICKSLIP_EXPECTS(folder_.empty());
    return blocks_[k / kBlock][k % kBlock];
  }
  [[nodiscard]] T front() const { return (*this)[0]; }
  [[nodiscard]] T back() const { return (*this)[size_ - 1]; }

  [[nodiscard]] const_iterator begin() const { return {this, 0}; }
  [[nodiscard]] const_iterator end() const { return {this, size_}; }
  [[nodiscard]] iterator begin() { return {this, 0}; }
  [[nodiscard]] iterator end() { return {this, size_}; }
  [[nodiscard]] auto rbegin() const { return std::make_reverse_iterator(end()); }
  [[nodiscard]] auto rend() const { return std::make_reverse_iterator(begin()); }

  friend bool operator==(const LongColumn& a, const LongColumn& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  using Buffer = std::shared_ptr<T[]>;  // NOLINT(modernize-avoid-c-arrays)
  static constexpr std::size_t kBlockBytes = kBlock * sizeof(T);

  void add_block() {
    // Where there is a file, every block but the last is in it.
    if (file_) {
      if (!blocks_.empty()) store(*file_, blocks_.size() - 1);
    } else if (!folder_.empty() && blocks_.size() == kResident) {
      auto file = std::make_shared<ScratchFile>(folder_);
      for (std::size_t block = 0; block < blocks_.size(); ++block) store(*file, block);
      file_ = std::move(file);
    }
    Buffer buffer = free_buffer(blocks_.size());
    blocks_.push_back(std::move(buffer));
    if (!folder_.empty()) resident_.push_back(blocks_.size() - 1);
  }

  void store(ScratchFile& file, std::size_t block) const {
    file.write(block * kBlockBytes, std::as_bytes(std::span{blocks_[block].get(), kBlock}));
  }

  const T* fetch(std::size_t block) const {
    Buffer buffer = free_buffer(blocks_.size() - 1);
    file_->read(block * kBlockBytes, std::as_writable_bytes(std::span{buffer.get(), kBlock}));
    blocks_[block] = std::move(buffer);
    resident_.push_back(block);
    return blocks_[block].get();
  }

  /// A new one, or that of the block fetched longest ago. \param last  the block that is not in the file.
  [[nodiscard]] Buffer free_buffer(std::size_t last) const {
    if (!file_ || resident_.size() < kResident) return std::make_shared_for_overwrite<T[]>(kBlock);
    const auto oldest =
        std::find_if(resident_.begin(), resident_.end(), [&](std::size_t block) { return block != last; });
    Buffer buffer = std::move(blocks_[*oldest]);
    resident_.erase(oldest);
    return buffer;
  }

  std::size_t size_ = 0;
  mutable std::vector<Buffer> blocks_;
  mutable std::vector<std::size_t> resident_;  ///< Blocks in memory, the latest last; only with a folder.
  std::filesystem::path folder_;               ///< Of the file; empty: all in memory.
  std::shared_ptr<ScratchFile> file_;
};

/// Iterator; the column must stay where it is. A const_iterator reads by value, since the element may move to
/// the file at the next access; an iterator gives a reference, without a folder only (contract).
template <typename T>
template <bool kConst>
class LongColumn<T>::Iterator {
 public:
  using Column = std::conditional_t<kConst, const LongColumn, LongColumn>;
  using iterator_category = std::random_access_iterator_tag;
  using value_type = T;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = std::conditional_t<kConst, T, T&>;

  Iterator() = default;
  Iterator(Column* column, std::size_t at) : column_(column), at_(at) {}

  [[nodiscard]] reference operator*() const { return (*column_)[at_]; }
  [[nodiscard]] reference operator[](difference_type n) const { return *(*this + n); }
  Iterator& operator+=(difference_type n) {
    at_ = static_cast<std::size_t>(static_cast<difference_type>(at_) + n);
    return *this;
  }
  Iterator& operator-=(difference_type n) { return *this += -n; }
  Iterator& operator++() { return *this += 1; }
  Iterator& operator--() { return *this -= 1; }
  Iterator operator++(int) { return std::exchange(*this, *this + 1); }
  Iterator operator--(int) { return std::exchange(*this, *this - 1); }
  [[nodiscard]] friend Iterator operator+(Iterator a, difference_type n) { return a += n; }
  [[nodiscard]] friend Iterator operator+(difference_type n, Iterator a) { return a += n; }
  [[nodiscard]] friend Iterator operator-(Iterator a, difference_type n) { return a -= n; }
  [[nodiscard]] friend difference_type operator-(const Iterator& a, const Iterator& b) {
    return static_cast<difference_type>(a.at_) - static_cast<difference_type>(b.at_);
  }
  auto operator<=>(const Iterator& other) const { return at_ <=> other.at_; }
  bool operator==(const Iterator& other) const { return at_ == other.at_; }

 private:
  Column* column_ = nullptr;
  std::size_t at_ = 0;
};

}  // namespace stickslip::base
