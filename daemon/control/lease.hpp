/// \file
/// The lease of the bench: one controller at a time may command, for a limited time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "daemon/types/lease_state.hpp"

namespace stickslip::control {

/// Times are nanoseconds of a monotonic clock. The holder is known by name only; access is restricted by the
/// socket's permissions and the token.
class Lease {
 public:
  /// Lease that each command takes.
  static constexpr double kCommand_s = 30.0;
  /// Lease that each step of a calibration takes: time to hang the next weight.
  static constexpr double kCalibration_s = 300.0;
  /// Longest lease that a client may ask for.
  static constexpr double kLongest_s = 3600.0;

  /// Takes or extends the lease; never shortens it. \return the holder if it is another one; then nothing
  /// changes.
  [[nodiscard]] std::optional<std::string> take(const std::string& who, double for_s, std::int64_t now_ns) {
    auto before = holder(now_ns);
    if (before && *before != who) return before;
    if (!before) until_ns_ = asked_until_ns_ = now_ns;
    until_ns_ = std::max(until_ns_, after(for_s, now_ns));
    who_ = who;
    return std::nullopt;
  }
  /// Takes the lease for a time that was asked for, from another client that holds it too. \param from  whose
  /// lease it is thought to be; one's own is extended, and never shortened. \return the holder if it is
  /// another one than `from` and `who`; then nothing changes.
  [[nodiscard]] std::optional<std::string> take_over(const std::string& who, const std::string& from,
                                                     double for_s, std::int64_t now_ns) {
    if (from != who && holder(now_ns) == from) who_.clear();
    if (auto other = take(who, for_s, now_ns)) return other;
    asked_until_ns_ = std::max(asked_until_ns_, after(for_s, now_ns));
    return std::nullopt;
  }
  /// Gives back what commands and steps took: the lease ends at once, or when the time that its holder asked
  /// for ends. Nothing changes if another controller holds it.
  void end_task(const std::string& who, std::int64_t now_ns) {
    if (holder(now_ns) == who) until_ns_ = asked_until_ns_;
  }
  /// Ends the lease. \return false if another controller holds it.
  [[nodiscard]] bool release(const std::string& who, std::int64_t now_ns) {
    if (const auto other = holder(now_ns); other && *other != who) return false;
    who_.clear();
    return true;
  }
  [[nodiscard]] std::optional<std::string> holder(std::int64_t now_ns) const {
    if (who_.empty() || now_ns >= until_ns_) return std::nullopt;
    return who_;
  }
  [[nodiscard]] daemon::LeaseState state(std::int64_t now_ns) const {
    if (!holder(now_ns)) return {};
    return {who_, 1e-9 * static_cast<double>(until_ns_ - now_ns)};
  }

 private:
  static std::int64_t after(double for_s, std::int64_t now_ns) {
    return now_ns + static_cast<std::int64_t>(for_s * 1e9);
  }

  std::string who_;
  std::int64_t until_ns_ = 0;
  std::int64_t asked_until_ns_ = 0;  ///< Of the lease that its holder asked for; not after until_ns_.
};

}  // namespace stickslip::control
