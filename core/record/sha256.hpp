/// \file
/// SHA-256 [FIPS 180-4], by OpenSSL.
#pragma once

#include <openssl/evp.h>

#include <memory>
#include <span>
#include <string>

namespace stickslip::record {

/// Throws HdfError where the algorithm is not available.
class Sha256 {
 public:
  Sha256();

  template <typename T>
  void add(std::span<const T> values) {
    add_bytes(std::as_bytes(values));
  }
  /// Once, at the end.
  [[nodiscard]] std::string hexadecimal();

 private:
  void add_bytes(std::span<const std::byte> bytes);

  std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

}  // namespace stickslip::record
