#include "io/traces/text_file.hpp"

#include <fcntl.h>
#include <iconv.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <span>

#include "core/base/regular_file.hpp"
#include "core/base/text.hpp"
#include "core/base/wording.hpp"
#include "core/record/file.hpp"

namespace stickslip::traces {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18U;
constexpr std::size_t kLongestLine = std::size_t{1} << 20U;
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";

struct Named {
  Encoding encoding;
  std::string_view name;
};
constexpr std::array kEncodings{
    Named{Encoding::kUtf8, "UTF-8"}, Named{Encoding::kUtf16LittleEndian, "UTF-16LE"},
    Named{Encoding::kUtf16BigEndian, "UTF-16BE"}, Named{Encoding::kWindows1252, "Windows-1252"}};

/// A file that begins so is no text. The conversion writes a table that can be imported.
struct Binary {
  std::string_view beginning;
  std::string_view what;
  std::string_view conversion;
};
constexpr std::array kBinaries{
    Binary{"PK\x03\x04", "a workbook of Excel or another zip archive",
           "import pandas; pandas.read_excel(\"{0}\").to_csv(\"{0}.csv\", index=False)"},
    Binary{"\xD0\xCF\x11\xE0", "a workbook of an old Excel",
           "import pandas; pandas.read_excel(\"{0}\").to_csv(\"{0}.csv\", index=False)"},
    Binary{"TDSm", "a TDMS file of LabVIEW",
           "import nptdms; nptdms.TdmsFile(\"{0}\").as_dataframe().to_csv(\"{0}.csv\", index=False)"}};

base::Result<void> refuse_binary(const std::string& path, std::string_view head) {
  for (const Binary& binary : kBinaries) {
    if (!head.starts_with(binary.beginning)) continue;
    return base::usage_error("{}: is {}, not text. Convert it: python3 -c '{}'", path, binary.what,
                             fmt::format(fmt::runtime(binary.conversion), path));
  }
  return {};
}

/// UTF-16 of a table is every other byte zero.
std::optional<Encoding> by_zero_bytes(std::string_view head) {
  std::array<std::size_t, 2> zeros{};
  for (std::size_t i = 0; i < head.size(); ++i) zeros[i % 2] += head[i] == '\0' ? 1U : 0U;
  const std::size_t most = head.size() / 2;
  if (zeros[1] > most / 2 && zeros[0] < most / 10) return Encoding::kUtf16LittleEndian;
  if (zeros[0] > most / 2 && zeros[1] < most / 10) return Encoding::kUtf16BigEndian;
  return std::nullopt;
}

/// Cuts a character that the end of a block splits.
std::string_view whole_characters(std::string_view text) {
  std::size_t tail = 0;
  while (tail < 3 && tail < text.size() &&
         (static_cast<unsigned char>(text[text.size() - 1 - tail]) & 0xC0U) == 0x80U)
    ++tail;
  if (tail < text.size()) {
    const auto lead = static_cast<unsigned char>(text[text.size() - 1 - tail]);
    const std::size_t length = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : lead >= 0xC0U ? 2 : 1;
    if (length > tail + 1) text.remove_suffix(tail + 1);
  }
  return text;
}

Encoding recognised(std::string_view head) {
  if (head.starts_with(kUtf8Mark)) return Encoding::kUtf8;
  if (head.starts_with("\xFF\xFE")) return Encoding::kUtf16LittleEndian;
  if (head.starts_with("\xFE\xFF")) return Encoding::kUtf16BigEndian;
  if (const auto wide = by_zero_bytes(head)) return *wide;
  return base::is_utf8(whole_characters(head)) ? Encoding::kUtf8 : Encoding::kWindows1252;
}

void close_converter(void* converter) { ::iconv_close(converter); }

}  // namespace

std::string_view name(Encoding encoding) noexcept {
  for (const Named& named : kEncodings) {
    if (named.encoding == encoding) return named.name;
  }
  return "UTF-8";
}

std::optional<Encoding> encoding_from_name(std::string_view text) noexcept {
  for (const Named& named : kEncodings) {
    if (named.name == text) return named.encoding;
  }
  if (text == "Latin-1" || text == "ISO-8859-1") return Encoding::kWindows1252;
  return std::nullopt;
}

base::Result<Source> Source::of(const std::string& path) {
  Source source{path, path, base::Descriptor{}, {}};
  std::error_code unknown;
  if (!std::filesystem::is_fifo(path, unknown) && !std::filesystem::is_socket(path, unknown)) return source;
  const auto text = base::read_text(path);
  if (!text) return tl::unexpected(text.error());
  source.copy = base::Descriptor{::memfd_create("trace", MFD_CLOEXEC)};
  if (source.copy.get() < 0 || record::write_all(source.copy.get(), std::as_bytes(std::span{*text}),
                                                 record::system_calls()) != text->size()) {
    return base::failure("{}: cannot be copied: {}", path, base::system_message(errno));
  }
  source.opened = fmt::format("/proc/self/fd/{}", source.copy.get());
  return source;
}

base::Result<TextFile> TextFile::open(const Source& source, std::optional<Encoding> encoding) {
  const std::string& path = source.path;
  auto opened = base::open_text(source.opened);
  if (!opened) return tl::unexpected(opened.error());
  TextFile file;
  file.path_ = path;
  file.file_ = std::move(opened->file);
  std::error_code unknown;  // The size is for the progress alone.
  if (const auto size = std::filesystem::file_size(source.opened, unknown); !unknown) file.size_ = size;
  file.sha256_ = std::make_unique<record::Sha256>();
  file.progress_ = source.progress;
  if (auto filled = file.fill(); !filled) return tl::unexpected(filled.error());
  if (auto text = refuse_binary(path, file.undecoded_); !text) return tl::unexpected(text.error());
  file.encoding_ = encoding.value_or(recognised(file.undecoded_));
  if (file.undecoded_.starts_with(kUtf8Mark) && file.encoding_ == Encoding::kUtf8) {
    file.undecoded_.erase(0, kUtf8Mark.size());
  }
  if (file.encoding_ != Encoding::kUtf8) {
    iconv_t const converter = ::iconv_open("UTF-8", std::string{name(file.encoding_)}.c_str());
    if (converter == reinterpret_cast<iconv_t>(-1)) {  // NOLINT: the interface of iconv.
      return base::failure("{}: this system cannot convert {}", path, name(file.encoding_));
    }
    file.converter_ = {converter, close_converter};
  }
  return file;
}

base::Result<void> TextFile::fill() {
  const std::size_t before = undecoded_.size();
  undecoded_.resize(before + kBlock);
  std::size_t got = 0;
  while (got < kBlock) {
    const ssize_t read = ::read(file_.get(), undecoded_.data() + before + got, kBlock - got);
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) return base::failure("{}: cannot be read: {}", path_, base::system_message(errno));
    if (read == 0) break;
    got += static_cast<std::size_t>(read);
  }
  undecoded_.resize(before + got);
  sha256_->add(std::span<const char>{undecoded_.data() + before, got});
  bytes_read_ += got;
  at_end_ = got < kBlock;
  if (progress_ && size_ > 0)
    progress_(std::min(1.0, static_cast<double>(bytes_read_) / static_cast<double>(size_)));
  return {};
}

void TextFile::decode() {
  decoded_.erase(0, at_);
  at_ = 0;
  if (!converter_) {
    decoded_ += undecoded_;
    undecoded_.clear();
    return;
  }
  // No character of these encodings takes more than three bytes of UTF-8 for each of its own.
  const std::size_t before = decoded_.size();
  decoded_.resize(before + 3 * undecoded_.size());
  char* from = undecoded_.data();
  std::size_t left = undecoded_.size();
  char* to = decoded_.data() + before;
  std::size_t room = decoded_.size() - before;
  const std::size_t unit = encoding_ == Encoding::kWindows1252 ? 1 : 2;
  while (left > 0 && ::iconv(converter_.get(), &from, &left, &to, &room) == static_cast<std::size_t>(-1)) {
    if (errno != EILSEQ && !(errno == EINVAL && at_end_)) break;
    // What is no character of the encoding is shown as such; it is in no number.
    const std::size_t skipped = std::min(left, unit);
    from += skipped;
    left -= skipped;
    if (room == 0) break;
    *to++ = '?';
    --room;
  }
  decoded_.resize(decoded_.size() - room);
  undecoded_.erase(0, undecoded_.size() - left);
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (line_number_ == 0 && before == 0 && decoded_.starts_with(kMark)) decoded_.erase(0, kMark.size());
}

namespace {

/// Place of the first LF or CR from `at` on; npos if there is none. Two searches for one byte each: one for
/// either of two looks at each byte by itself.
std::size_t line_end(const std::string& text, std::size_t at) {
  const std::size_t feed = text.find('\n', at);
  const std::size_t carriage = std::string_view{text}.substr(at, feed - at).find('\r');
  return carriage == std::string_view::npos ? feed : at + carriage;
}

}  // namespace

base::Result<bool> TextFile::next(std::string& line) {
  line.clear();
  while (true) {
    const std::size_t end = line_end(decoded_, at_);
    // A CR at the end of what is decoded may belong to a CR LF.
    if (end != std::string::npos && (decoded_[end] == '\n' || end + 1 < decoded_.size())) {
      line.assign(decoded_, at_, end - at_);
      at_ = end + (decoded_[end] == '\r' && decoded_[end + 1] == '\n' ? 2 : 1);
      ++line_number_;
      return true;
    }
    if (decoded_.size() - at_ > kLongestLine) {
      return base::usage_error("{}:{}: the line is longer than {} bytes: this is no table of text", path_,
                               line_number_ + 1, kLongestLine);
    }
    if (at_end_ && undecoded_.empty()) {
      if (at_ == decoded_.size()) return false;
      line_was_ended_ = end != std::string::npos;
      line.assign(decoded_, at_, line_was_ended_ ? end - at_ : std::string::npos);
      at_ = decoded_.size();
      ++line_number_;
      return true;
    }
    if (!at_end_ && undecoded_.size() < kBlock) {
      if (auto filled = fill(); !filled) return tl::unexpected(filled.error());
    }
    decode();
  }
}

}  // namespace stickslip::traces
