#include <fmt/format.h>

#include "core/accuracy/method.hpp"
#include "core/accuracy/peer_sled.hpp"
#include "core/accuracy/plain_belt.hpp"

namespace stickslip::accuracy {
namespace {

using sim::Motion;

class Euler final : public Method {
 public:
  explicit Euler(int steps_per_scan) : steps_per_scan_(steps_per_scan) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "semi-implicit Euler"; }
  [[nodiscard]] std::string setting() const override {
    return fmt::format("{} steps a scan", steps_per_scan_);
  }
  [[nodiscard]] std::string_view lacks(const Motion& motion) const noexcept override {
    return lacks_reference(motion);
  }
  RunOutcome run(const Motion& motion, double scan_rate_Hz, std::uint64_t /*seed*/,
                 std::span<double> coefficient) const override {
    const PeerSled sled{motion};
    const double steps_per_s = scan_rate_Hz * steps_per_scan_;
    const double step_s = 1.0 / steps_per_s;
    PlainBelt belt{motion};
    double c = PeerSled::start_c(motion);
    double rate = PeerSled::start_rate(motion);
    double belt_rate = rate;
    double side = 1.0;  // Of the belt's speed on which the sled slides: 1 slower, −1 faster.
    bool sticks = true;
    std::int64_t captures = 0;
    std::int64_t step = 0;
    for (double& reading : coefficient) {
      reading = sled.one_way ? std::fmax(c, 0.0) : c;
      for (int i = 0; i < steps_per_scan_; ++i, ++step) {
        // Half a step early: the time of a step is only written to a rounding.
        if (belt.end_s() <= (static_cast<double>(step) + 0.5) * step_s) {
          belt.pass((static_cast<double>(step) + 0.5) * step_s);
        }
        if (belt.halts_when_unloaded() && c <= 0.0) belt.halt();
        if (belt.rate() != belt_rate) {
          belt_rate = belt.rate();
          sticks = false;
          side = rate < belt_rate ? 1.0 : -1.0;
        }
        if (sticks && !sled.holds(c, belt_rate)) {
          sticks = false;
          side = c > 0.0 ? 1.0 : -1.0;
        }
        if (!sticks) {
          rate += step_s * (sled.pull(c, rate) + side * sled.omega0_squared * sled.K);
          if (side * (rate - belt_rate) >= 0.0) {
            captures += !sled.one_way || c >= 0.0 ? 1 : 0;
            sticks = sled.holds(c, belt_rate);
            if (sticks) {
              rate = belt_rate;
            } else {
              side = -side;
            }
          }
        }
        c += step_s * rate;
      }
    }
    return {captures, 0};
  }

 private:
  int steps_per_scan_;
};

}  // namespace

std::unique_ptr<Method> make_euler(int steps_per_scan) { return std::make_unique<Euler>(steps_per_scan); }

}  // namespace stickslip::accuracy
