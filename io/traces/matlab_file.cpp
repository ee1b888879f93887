#include "io/traces/matlab_file.hpp"

#include <fmt/format.h>
#include <matio.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <utility>

namespace stickslip::traces {
namespace {

using record::NumberColumn;

static_assert(std::endian::native == std::endian::little);

// ["MAT-File Format", The MathWorks]
constexpr std::size_t kHeader5 = 128;
constexpr std::size_t kVersionPlace = 124;
constexpr std::size_t kHeader4 = 20;
constexpr std::uint32_t kLongestName4 = 256;
constexpr std::size_t kDeepestField = 8;
constexpr std::size_t kMostColumns = 10'000;

std::uint32_t word(std::string_view bytes, std::size_t at, bool big_endian) {
  std::array<char, 4> own{};
  std::copy_n(bytes.data() + at, own.size(), own.begin());
  if (big_endian) std::reverse(own.begin(), own.end());
  return std::bit_cast<std::uint32_t>(own);
}

/// Header of a matrix of version 4.
struct Header4 {
  std::uint64_t size = 0;  ///< Of the matrix with its name, bytes.
  std::uint32_t name_size = 0;
};

/// Nothing for what is no such header.
std::optional<Header4> header4(std::string_view bytes) {
  if (bytes.size() < kHeader4) return std::nullopt;
  constexpr std::array<std::uint64_t, 6> kSizes{8, 4, 4, 2, 2, 1};
  for (const bool big_endian : {false, true}) {
    const std::uint32_t type = word(bytes, 0, big_endian);
    const std::uint32_t precision = type / 10 % 10;
    if (type / 1000 != (big_endian ? 1U : 0U) || type / 100 % 10 != 0 || precision >= kSizes.size() ||
        type % 10 > 2)
      continue;
    const std::uint32_t imaginary = word(bytes, 12, big_endian);
    const std::uint32_t name_size = word(bytes, 16, big_endian);
    if (imaginary > 1 || name_size < 2 || name_size > kLongestName4) continue;
    const std::uint64_t count =
        std::uint64_t{word(bytes, 4, big_endian)} * word(bytes, 8, big_endian) * (imaginary + 1);
    return Header4{name_size + count * kSizes[precision], name_size};
  }
  return std::nullopt;
}

/// The name of the first matrix: a word with its NUL.
bool has_name4(std::string_view bytes, std::uint32_t size) {
  if (bytes.size() < kHeader4 + size) return false;
  const std::string_view name = bytes.substr(kHeader4, size);
  return name.back() == '\0' && std::all_of(name.begin(), name.end() - 1,
                                            [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

/// The next `size` bytes are one stream of zlib, whose checksum libmatio does not compare.
bool is_sound_stream(std::ifstream& file, std::uint64_t size) {
  constexpr std::size_t kBlock = std::size_t{1} << 16U;
  std::vector<char> packed(kBlock);
  std::vector<Bytef> unpacked(4 * kBlock);
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  const std::unique_ptr<z_stream, int (*)(z_stream*)> owner{&stream, inflateEnd};
  int status = Z_OK;
  while (status == Z_OK && size > 0) {
    const std::uint64_t next = std::min<std::uint64_t>(size, kBlock);
    if (!file.read(packed.data(), static_cast<std::streamsize>(next))) return false;
    size -= next;
    stream.next_in = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_in = static_cast<uInt>(next);
    do {
      stream.next_out = unpacked.data();
      stream.avail_out = static_cast<uInt>(unpacked.size());
      status = inflate(&stream, Z_NO_FLUSH);
    } while (status == Z_OK && stream.avail_out == 0);
    if (status == Z_BUF_ERROR) status = Z_OK;  // It waits for the next block.
  }
  return status == Z_STREAM_END;
}

/// libmatio gives what stands before the cut, without a word: the sizes in the file are compared with its
/// own.
bool is_whole(const std::string& path, mat_ft version) {
  std::ifstream file{path, std::ios::binary | std::ios::ate};
  const auto size = static_cast<std::uint64_t>(file.tellg());
  std::array<char, kHeader5> bytes{};
  const std::string_view head{bytes.data(), bytes.size()};
  if (version == MAT_FT_MAT4) {
    std::uint64_t at = 0;
    while (at < size) {
      file.seekg(static_cast<std::streamoff>(at));
      if (!file.read(bytes.data(), kHeader4)) return false;
      const auto header = header4(head);
      if (!header || header->size > size - at) return false;
      at += kHeader4 + header->size;
    }
    return at == size;
  }
  if (version != MAT_FT_MAT5) return true;  // HDF5 looks itself.
  file.seekg(0);
  if (!file.read(bytes.data(), kHeader5)) return false;
  const bool big_endian = bytes[kVersionPlace + 2] == 'M';
  std::uint64_t at = kHeader5;
  while (at < size) {
    constexpr std::size_t kTag = 8;
    file.seekg(static_cast<std::streamoff>(at));
    if (!file.read(bytes.data(), kTag)) return false;
    const std::uint64_t length = word(head, 4, big_endian);
    if (length > size - at - kTag) return false;
    if (word(head, 0, big_endian) == MAT_T_COMPRESSED && !is_sound_stream(file, length)) return false;
    at += kTag + length;
  }
  return at == size;
}

void be_silent(int /*level*/, char* /*message*/) {}

using Variable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

/// What keeps a variable from being a column; `single` for those of few digits.
void judge_class(const matvar_t& variable, NumberColumn& column) {
  if (variable.isComplex != 0) {
    column.why = "is complex";
    return;
  }
  switch (variable.class_type) {
    case MAT_C_SINGLE:
      column.single = true;
      return;
    case MAT_C_DOUBLE:
    case MAT_C_INT8:
    case MAT_C_UINT8:
    case MAT_C_INT16:
    case MAT_C_UINT16:
    case MAT_C_INT32:
    case MAT_C_UINT32:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      return;
    case MAT_C_CELL:
      column.why = "is a cell array";
      return;
    case MAT_C_STRUCT:
      column.why = "is an array of structs";
      return;
    case MAT_C_CHAR:
      column.why = "is text";
      return;
    case MAT_C_SPARSE:
      column.why = "is sparse";
      return;
    case MAT_C_EMPTY:
      column.why = "is empty";
      return;
    case MAT_C_OBJECT:
    case MAT_C_OPAQUE:
    case MAT_C_FUNCTION:
      column.why = "is an object";
      return;
  }
  column.why = "is not of numbers";
}

std::vector<std::uint64_t> axes_of(const matvar_t& variable) {
  if (variable.rank <= 0 || variable.dims == nullptr) return {0};
  return {variable.dims, variable.dims + variable.rank};
}

bool is_one_struct(const matvar_t& variable) {
  const auto axes = axes_of(variable);
  return variable.class_type == MAT_C_STRUCT &&
         std::all_of(axes.begin(), axes.end(), [](std::uint64_t size) { return size == 1; });
}

void add_variable(matvar_t* variable, const std::string& path, std::size_t depth,
                  std::vector<NumberColumn>& columns) {
  if (columns.size() >= kMostColumns) return;
  NumberColumn column;
  column.path = path;
  if (variable == nullptr) {
    column.why = "is empty";
  } else if (is_one_struct(*variable) && depth < kDeepestField) {
    const unsigned count = Mat_VarGetNumberOfFields(variable);
    char* const* names = Mat_VarGetStructFieldnames(variable);
    for (unsigned i = 0; names != nullptr && i < count; ++i) {
      if (names[i] == nullptr) continue;
      add_variable(Mat_VarGetStructFieldByIndex(variable, i, 0), path + "." + names[i], depth + 1, columns);
    }
    return;
  } else {
    judge_class(*variable, column);
  }
  if (column.why.empty()) {
    record::add_parts(std::move(column), axes_of(*variable), columns);
  } else {
    columns.push_back(std::move(column));
  }
}

/// Every `step`th number from `first` on. Empty if the variable has fewer than it says.
template <typename Stored>
std::vector<double> numbers(const matvar_t& variable, std::uint64_t first, std::uint64_t step,
                            std::uint64_t count) {
  const std::uint64_t stored_count = variable.nbytes / sizeof(Stored);
  if (variable.data == nullptr || stored_count <= first || (stored_count - first - 1) / step < count - 1)
    return {};
  const auto* stored = static_cast<const Stored*>(variable.data) + first;
  std::vector<double> values(count);
  for (std::uint64_t i = 0; i < count; ++i) values[i] = static_cast<double>(stored[i * step]);
  return values;
}

std::vector<double> numbers_of(const matvar_t& variable, std::uint64_t first, std::uint64_t step,
                               std::uint64_t count) {
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      return numbers<double>(variable, first, step, count);
    case MAT_T_SINGLE:
      return numbers<float>(variable, first, step, count);
    case MAT_T_INT8:
      return numbers<std::int8_t>(variable, first, step, count);
    case MAT_T_UINT8:
      return numbers<std::uint8_t>(variable, first, step, count);
    case MAT_T_INT16:
      return numbers<std::int16_t>(variable, first, step, count);
    case MAT_T_UINT16:
      return numbers<std::uint16_t>(variable, first, step, count);
    case MAT_T_INT32:
      return numbers<std::int32_t>(variable, first, step, count);
    case MAT_T_UINT32:
      return numbers<std::uint32_t>(variable, first, step, count);
    case MAT_T_INT64:
      return numbers<std::int64_t>(variable, first, step, count);
    case MAT_T_UINT64:
      return numbers<std::uint64_t>(variable, first, step, count);
    default:
      return {};
  }
}

}  // namespace

bool is_matlab(std::string_view head) {
  if (head.starts_with("MATLAB 5.0 MAT-file") || head.starts_with("MATLAB 7.3 MAT-file")) return true;
  if (head.size() >= kHeader5) {
    using namespace std::string_view_literals;
    const std::string_view version = head.substr(kVersionPlace, 4);
    if (version == "\x00\x01IM"sv || version == "\x01\x00MI"sv) return true;
  }
  const auto first = header4(head);
  return first && has_name4(head, first->name_size);
}

struct MatlabColumns::Opened {
  std::unique_ptr<mat_t, int (*)(mat_t*)> file{nullptr, Mat_Close};
  std::vector<NumberColumn> columns;
  Variable latest{nullptr, Mat_VarFree};  ///< That was read: its other columns may follow.
  std::string latest_name;
};

MatlabColumns::MatlabColumns(std::unique_ptr<Opened> opened) : opened_(std::move(opened)) {}
MatlabColumns::MatlabColumns(MatlabColumns&&) noexcept = default;
MatlabColumns& MatlabColumns::operator=(MatlabColumns&&) noexcept = default;
MatlabColumns::~MatlabColumns() = default;

const std::vector<NumberColumn>& MatlabColumns::columns() const noexcept { return opened_->columns; }

std::string MatlabColumns::format() const {
  switch (Mat_GetVersion(opened_->file.get())) {
    case MAT_FT_MAT4:
      return "MATLAB 4";
    case MAT_FT_MAT73:
      return "MATLAB 7.3";
    default:
      return "MATLAB 5";
  }
}

base::Result<MatlabColumns> MatlabColumns::open(const std::string& path) {
  Mat_LogInitFunc("stickslip", be_silent);
  auto opened = std::make_unique<Opened>();
  opened->file.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!opened->file || !is_whole(path, Mat_GetVersion(opened->file.get())))
    return base::usage_error("is a file of MATLAB but cut short or damaged: take it from a backup");
  while (const Variable variable{Mat_VarReadNextInfo(opened->file.get()), Mat_VarFree}) {
    if (variable->name != nullptr) add_variable(variable.get(), variable->name, 0, opened->columns);
  }
  return MatlabColumns{std::move(opened)};
}

base::Result<std::vector<double>> MatlabColumns::read(const NumberColumn& column) {
  const std::string name = column.path.substr(0, column.path.find('.'));
  if (!opened_->latest || opened_->latest_name != name) {
    opened_->latest.reset();
    opened_->latest.reset(Mat_VarRead(opened_->file.get(), name.c_str()));
    opened_->latest_name = name;
  }
  matvar_t* variable = opened_->latest.get();
  for (std::size_t at = name.size(); variable != nullptr && at < column.path.size();) {
    const std::size_t next = std::min(column.path.find('.', at + 1), column.path.size());
    variable = is_one_struct(*variable) ? Mat_VarGetStructFieldByName(
                                              variable, column.path.substr(at + 1, next - at - 1).c_str(), 0)
                                        : nullptr;
    at = next;
  }
  std::vector<double> values;
  if (variable != nullptr) {
    const std::vector<std::uint64_t> axes = axes_of(*variable);
    NumberColumn judged;
    judge_class(*variable, judged);
    const record::ArrayShape shape = record::shape_of(axes, judged);
    const std::uint64_t part = record::part_number(column);
    if (judged.why.empty() && shape.size == column.size && part < shape.count) {
      // The first axis runs fastest.
      const auto step = [&axes](std::size_t axis) {
        std::uint64_t product = 1;
        for (std::size_t a = 0; a < axis; ++a) product *= axes[a];
        return product;
      };
      values = numbers_of(*variable, part * step(shape.short_axis), step(shape.long_axis), shape.size);
    }
  }
  if (values.empty()) {
    return base::usage_error("{}{} cannot be read: the file is damaged; take it from a backup", column.path,
                             column.part);
  }
  return values;
}

}  // namespace stickslip::traces
