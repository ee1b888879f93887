#include "io/traces/row_reader.hpp"

#include <new>

#include "io/traces/cell.hpp"

namespace stickslip::traces {
namespace {

/// In no text file.
constexpr char kUnused = '\x1F';

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
  if (complete_ || text_.empty()) {
    text_.clear();
    places_.clear();
    complete_ = false;
  }
  line_.clear();
  if (separator_ == kBlanks) {
    for (const char c : trimmed(line)) {
      if (c != ' ' && c != '\t') {
        line_ += c;
      } else if (line_.back() != kUnused) {
        line_ += kUnused;
      }
    }
  } else {
    line_ = line;
  }
  line_ += '\n';
  // Out of memory is the only error of a parser that is not strict.
  if (csv_parse(parser_.get(), line_.data(), line_.size(), on_field, on_row, this) != line_.size())
    throw std::bad_alloc();
  if (!complete_) return false;
  fields_.clear();
  for (const auto& [begin, size] : places_) fields_.push_back(std::string_view{text_}.substr(begin, size));
  return true;
}

void RowReader::on_field(void* text, std::size_t size, void* self) {
  auto& reader = *static_cast<RowReader*>(self);
  reader.places_.emplace_back(reader.text_.size(), size);
  if (text != nullptr) reader.text_.append(static_cast<const char*>(text), size);
}

void RowReader::on_row(int /*character*/, void* self) { static_cast<RowReader*>(self)->complete_ = true; }

}  // namespace stickslip::traces
