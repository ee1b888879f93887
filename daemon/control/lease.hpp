/// \file
/// One controller at a time: who commands has the bench for a while, and everybody else is told who.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace stickslip::control {

/// Times are nanoseconds of any clock that never steps. Who holds it is a name, no secret: the socket's
/// permissions and the token keep strangers out.
class Lease {
 public:
  /// Each command keeps the bench for so long.
  static constexpr double kCommand_s = 30.0;
  /// Each step of a calibration: somebody lifts a weight to the hook.
  static constexpr double kCalibration_s = 300.0;
  static constexpr double kLongest_s = 3600.0;

  /// Takes it or makes it longer, never shorter. \return who holds it, if that is somebody else.
  [[nodiscard]] std::optional<std::string> take(const std::string& who, double for_s, std::int64_t now_ns) {
    if (auto other = holder(now_ns); other && *other != who) return other;
    const std::int64_t until_ns = now_ns + static_cast<std::int64_t>(for_s * 1e9);
    if (!holder(now_ns) || until_ns > until_ns_) until_ns_ = until_ns;
    who_ = who;
    return std::nullopt;
  }
  /// \return false if somebody else holds it.
  [[nodiscard]] bool release(const std::string& who, std::int64_t now_ns) {
    if (const auto other = holder(now_ns); other && *other != who) return false;
    who_.clear();
    return true;
  }
  [[nodiscard]] std::optional<std::string> holder(std::int64_t now_ns) const {
    if (who_.empty() || now_ns >= until_ns_) return std::nullopt;
    return who_;
  }
  /// Until it is free, s.
  [[nodiscard]] double left_s(std::int64_t now_ns) const {
    return holder(now_ns) ? 1e-9 * static_cast<double>(until_ns_ - now_ns) : 0.0;
  }

 private:
  std::string who_;
  std::int64_t until_ns_ = 0;
};

}  // namespace stickslip::control
