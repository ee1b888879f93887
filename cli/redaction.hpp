/// \file
/// What `stickslip bundle` leaves out: secrets always, and what people typed unless it is wanted.
///
/// Of a configuration only the values of known keys stay, so that a password in a wrong place goes too. Text
/// of other origin (log, messages) loses what has the form of a secret.
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

  /// Keys of the configuration whose files hold a secret. Relative names are of the configuration's folder,
  /// those of control.token_file of the working directory.
  static constexpr std::string_view kSecretFiles[] = {"fleet.password_file", "fleet.key_file",
                                                      "control.token_file"};

  /// The text of stickslipd.toml, valid or not, without comments, values of unknown keys, the broker's user,
  /// and names of kSecretFiles where there is no such file: a name without a file may be the secret. lines()
  /// then knows these. \param folder  of the configuration.
  [[nodiscard]] std::string configuration(std::string_view text, const std::filesystem::path& folder);
  /// Another TOML file (method, calibration, characterisation), without comments.
  [[nodiscard]] std::string toml(std::string_view text) const;
  /// JSON of the daemon, of a record or of the doctor.
  [[nodiscard]] nlohmann::ordered_json json(nlohmann::ordered_json json) const;
  /// Lines of any text. Removed: user and password in a URL, what follows "password", "token" and the like,
  /// values of a refused key that configuration() does not show, and lines of more than 4000 bytes.
  [[nodiscard]] std::string lines(std::string_view text) const;

 private:
  [[nodiscard]] bool shows(const std::string& key) const;
  [[nodiscard]] std::string line(std::string_view text) const;

  bool keeps_names_;
  std::set<std::string, std::less<>> known_keys_;
  std::vector<std::string> secrets_;  ///< Removed from any text.
};

}  // namespace stickslip::cli
