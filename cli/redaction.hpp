/// \file
/// What `stickslip bundle` shows and what it leaves out.
///
/// Of settings it shows only what cannot be a secret, wherever somebody typed one. Text of other origin (log,
/// messages) loses what has the form of a secret, and may hold more. What people typed stays if it is wanted.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace stickslip::cli {

class Redaction {
 public:
  /// \param keeps_names  true: operators, samples and other typed texts stay.
  explicit Redaction(bool keeps_names);

  /// The text of stickslipd.toml, valid or not: known keys, and of these numbers, switches, and words of a
  /// few keys that hold no secret. Everything else is removed.
  [[nodiscard]] std::string configuration(std::string_view text) const;
  /// Another TOML file (method, calibration, characterisation): its numbers and switches.
  [[nodiscard]] std::string toml(std::string_view text) const;
  /// JSON of the daemon, of a record or of the doctor.
  [[nodiscard]] nlohmann::ordered_json json(nlohmann::ordered_json json) const;
  /// Lines of any text. Removed: what stands before '@', what follows "password", "token" and the like, a
  /// refused value of the configuration, and lines of more than 500 bytes.
  [[nodiscard]] std::string lines(std::string_view text) const;

 private:
  [[nodiscard]] std::string line(std::string_view text) const;

  bool keeps_names_;
  std::set<std::string, std::less<>> known_keys_;
};

}  // namespace stickslip::cli
