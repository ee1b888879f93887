#include "io/traces/row_reader.hpp"

#include <algorithm>
#include <new>

#include "io/traces/cell.hpp"

namespace stickslip::traces {
namespace {

/// In no text file.
constexpr char kUnused = '\x1F';
constexpr std::string_view kArrow = "->";

void close_parser(csv_parser* parser) {
  csv_free(parser);
  delete parser;  // NOLINT(cppcoreguidelines-owning-memory): the deleter of the pointer below.
}

}  // namespace

std::string_view separator_name(char separator) noexcept {
  switch (separator) {
    case ',':
      return "comma";
    case ';':
      return "semicolon";
    case '\t':
      return "tab";
    case '|':
      return "bar";
    case kBlanks:
      return "blanks";
    default:
      return "none";
  }
}

RowReader::RowReader(char separator) : separator_(separator), parser_(new csv_parser{}, close_parser) {
  if (csv_init(parser_.get(), CSV_APPEND_NULL) != 0) throw std::bad_alloc();
  csv_set_delim(parser_.get(), static_cast<unsigned char>(
                                   separator == kBlanks || separator == kNoSeparator ? kUnused : separator));
}

bool RowReader::add(std::string_view line) {
  if (complete_) {
    text_.clear();
    places_.clear();
  }
  line_.clear();
  if (separator_ == kBlanks) {
    std::string_view rest = trimmed(line);
    while (!rest.empty()) {
      const std::size_t size = std::min(rest.find_first_of(" \t"), rest.size());
      const std::string_view word = rest.substr(0, size);
      rest = trimmed(rest.substr(size));
      // Loggers write "12:00:01.123 -> 0.34".
      if (word == kArrow) continue;
      if (!line_.empty()) line_ += kUnused;
      line_ += word;
    }
  } else {
    line_ = line;
  }
  fields_.clear();
  if (complete_ && line_.find('"') == std::string::npos) {
    split();
    return true;
  }
  complete_ = false;
  line_ += '\n';
  // Out of memory is the only error of a parser that is not strict.
  if (csv_parse(parser_.get(), line_.data(), line_.size(), on_field, on_row, this) != line_.size())
    throw std::bad_alloc();
  if (!complete_) return false;
  for (const auto& [begin, size] : places_) fields_.push_back(std::string_view{text_}.substr(begin, size));
  return true;
}

void RowReader::split() {
  const char delimiter = static_cast<char>(csv_get_delim(parser_.get()));
  const auto is_blank = [delimiter](char c) { return (c == ' ' || c == '\t') && c != delimiter; };
  std::string_view rest = line_;
  while (true) {
    const std::size_t size = std::min(rest.find(delimiter), rest.size());
    std::string_view field = rest.substr(0, size);
    while (!field.empty() && is_blank(field.front())) field.remove_prefix(1);
    while (!field.empty() && is_blank(field.back())) field.remove_suffix(1);
    fields_.push_back(field);
    if (size == rest.size()) return;
    rest.remove_prefix(size + 1);
  }
}

void RowReader::on_field(void* text, std::size_t size, void* self) {
  auto& reader = *static_cast<RowReader*>(self);
  reader.places_.emplace_back(reader.text_.size(), size);
  if (text != nullptr) reader.text_.append(static_cast<const char*>(text), size);
}

void RowReader::on_row(int /*character*/, void* self) { static_cast<RowReader*>(self)->complete_ = true; }

}  // namespace stickslip::traces
