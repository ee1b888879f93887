#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <memory>

#include "core/record/hdf_read.hpp"
#include "core/record/hdf_write.hpp"
#include "core/record/layout.hpp"
#include "core/record/words.hpp"

namespace stickslip::record {
namespace {

constexpr FieldName kComputeTime{"compute_time", "s", "time the evaluation took [s]"};

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    expect(context_ != nullptr && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }

  template <typename T>
  void add(const std::vector<T>& values) {
    expect(EVP_DigestUpdate(context_.get(), values.data(), values.size() * sizeof(T)) == 1);
  }

  [[nodiscard]] std::string hexadecimal() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    expect(EVP_DigestFinal_ex(context_.get(), digest.data(), &size) == 1);
    std::string text;
    for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  static void expect(bool done) {
    if (!done) throw HdfError("SHA-256 is not available");
  }
  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

}  // namespace

std::string sha256_of_raw(const Record& record) {
  Sha256 sha;
  if (record.header.board.quantity != daq::RawQuantity::kCounts) {
    sha.add(record.raw);
  } else if (counts_fit_u16(record.header.board)) {
    sha.add(std::vector<std::uint16_t>(record.raw.begin(), record.raw.end()));
  } else {
    sha.add(std::vector<std::uint32_t>(record.raw.begin(), record.raw.end()));
  }
  return sha.hexadecimal();
}

void write_process(hid_t entry, const Record& record) {
  const GroupHandle group = make_group(entry, "process", "NXprocess");
  const FieldWriter write{group.get()};
  for_each_field(record.header.process, write);
  write_text(group.get(), "status", name(record.end->status));
  write_texts(group.get(), "reasons", record.end->reasons);
  write(FieldName{"end_cause", "", ""}, record.end->cause);
  write(kComputeTime, record.end->compute_time_s);
  write_text(group.get(), "sha256", sha256_of_raw(record));
}

void read_process(hid_t entry, Record& record) {
  const GroupHandle group = open_group(entry, "process");
  const FieldReader read{group.get()};
  for_each_field(record.header.process, read);
  const std::string status = read_text(group.get(), "status");
  const auto known = status_from_name(status);
  if (!known) throw HdfError(fmt::format("process/status '{}' is unknown", status));
  record.end->status = *known;
  record.end->reasons = read_texts(group.get(), "reasons");
  read(FieldName{"end_cause", "", ""}, record.end->cause);
  read(kComputeTime, record.end->compute_time_s);
  record.sha256 = read_text(group.get(), "sha256");
}

}  // namespace stickslip::record
