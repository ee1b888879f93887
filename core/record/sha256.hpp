/// \file
/// SHA-256 [FIPS 180-4], by OpenSSL.
#pragma once

#include <openssl/evp.h>

#include <memory>
#include <span>
#include <string>

namespace stickslip::record {

/// Computes one digest. Functions throw HdfError if OpenSSL does not provide the algorithm.
class Sha256 {
 public:
  Sha256();

  /// Adds the bytes of the values as they are in memory.
  template <typename T>
  void add(std::span<const T> values) {
    add_bytes(std::as_bytes(values));
  }
  /// The digest, 64 lower-case hexadecimal digits. To be called once, after the last add().
  [[nodiscard]] std::string hexadecimal();

 private:
  void add_bytes(std::span<const std::byte> bytes);

  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

}  // namespace stickslip::record
