/// \file
/// Lines of a text file in any of the encodings in which programs export traces, as UTF-8.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/descriptor.hpp"
#include "core/base/result.hpp"
#include "core/record/sha256.hpp"

namespace stickslip::traces {

enum class Encoding { kUtf8, kUtf16LittleEndian, kUtf16BigEndian, kWindows1252 };

/// As --encoding takes it: "UTF-8", "UTF-16LE", "UTF-16BE", "Windows-1252" (of which Latin-1 is a part).
[[nodiscard]] std::string_view name(Encoding encoding) noexcept;
[[nodiscard]] std::optional<Encoding> encoding_from_name(std::string_view text) noexcept;

/// A file that can be read twice: a pipe is copied into memory.
struct Source {
  std::string path;       ///< As the user gave it, for messages.
  std::string opened;     ///< What is opened in its place.
  base::Descriptor copy;  ///< Of a pipe.
  /// Told from time to time which part has been read, 0 … 1, by the thread that reads; may be empty.
  std::function<void(double)> progress{};

  /// Errors: base::open_text().
  [[nodiscard]] static base::Result<Source> of(const std::string& path);
};

/// Reads from front to back; a line ends with LF, CR LF or CR. Memory: one block and one line.
class TextFile {
 public:
  /// \param encoding  stated by the user; else a byte order mark decides, else the zero bytes of UTF-16, else
  ///        whether the first block is UTF-8.
  /// Errors: base::open_text(); kUsage for a file that is no text, with what it is and how to convert it.
  [[nodiscard]] static base::Result<TextFile> open(const Source& source, std::optional<Encoding> encoding);

  /// The next line without its end. \return false at the end of the file. Errors: kFailure if the file cannot
  /// be read, kUsage for a line longer than 1 MiB.
  [[nodiscard]] base::Result<bool> next(std::string& line);

  [[nodiscard]] Encoding encoding() const noexcept { return encoding_; }
  [[nodiscard]] std::int64_t line_number() const noexcept {
    return line_number_;
  }  ///< Of the last line read.
  /// Whether the last line read had an end. Only the last line of a file can lack one.
  [[nodiscard]] bool line_was_ended() const noexcept { return line_was_ended_; }
  [[nodiscard]] std::uint64_t bytes_read() const noexcept { return bytes_read_; }
  /// Of all bytes, once the end has been reached. Call once.
  [[nodiscard]] std::string sha256() { return sha256_->hexadecimal(); }

 private:
  TextFile() = default;
  /// Appends the next block to undecoded_.
  [[nodiscard]] base::Result<void> fill();
  /// Moves the whole characters of undecoded_ to decoded_.
  void decode();

  std::string path_;
  base::Descriptor file_;
  Encoding encoding_ = Encoding::kUtf8;
  std::unique_ptr<void, void (*)(void*)> converter_{nullptr, nullptr};  ///< Null for UTF-8.
  std::unique_ptr<record::Sha256> sha256_;
  std::string undecoded_;
  std::string decoded_;
  std::size_t at_ = 0;  ///< Of the next line in decoded_.
  bool at_end_ = false;
  bool line_was_ended_ = true;
  std::int64_t line_number_ = 0;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t size_ = 0;  ///< Of the file when it was opened, bytes.
  std::function<void(double)> progress_;
};

}  // namespace stickslip::traces
