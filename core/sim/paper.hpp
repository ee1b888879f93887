/// \file
/// The paper: S and K of the present contact.
///
///     Paper paper{settings, 0.35, 0.30};
///     paper.restart(seed);
///     paper.renew();            // The sled has come to rest on a new place:
///     paper.now().mu_s;         // what holds it there, and
///     paper.now().mu_k;         // what it will slide with.
///
/// A contact begins at a capture and keeps its S and K during the stick and the slip that ends it. Each
/// effect is a small class that changes the two; only the effects listed in the scene are created.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace stickslip::sim {

/// Effect `scatter` (motion): S and K vary from place to place.
struct Scatter {
  double delta_mu_cv =
      0.0;               ///< Coefficient of variation of S − K, log-normal about the scene's: never S < K.
  double mu_k_sd = 0.0;  ///< Of K, normal; K never goes below zero.
  double correlation_length_m = std::numeric_limits<double>::infinity();  ///< > 0, of sliding.
};

/// Effect `first_peak` (motion): S of the first slip differs from the others.
struct FirstPeak {
  double change = 0.0;  ///< Added to S until the first slip; S never goes below K.
  double sd = 0.0;      ///< Of the change, normal from run to run.
};

/// Effect `contact_ageing` (motion): S grows with the time t that a contact has rested, as
/// S + β log₁₀(1 + t/t₀); nothing at t = 0. [Dieterich, J. Geophys. Res. 77(20):3690–3697, 1972]
struct ContactAgeing {
  double per_decade = 0.0;  ///< β ≥ 0, as a coefficient.
  double cutoff_s = 0.001;  ///< t₀ > 0

  [[nodiscard]] double growth(double rested_s) const noexcept;
  /// First derivative, 1/s, and absolute value of the second, 1/s²; both decrease monotonically.
  [[nodiscard]] double growth_rate_per_s(double rested_s) const noexcept;
  [[nodiscard]] double growth_bend_per_s2(double rested_s) const noexcept;
  /// First t ≥ 0 at which held + rate · t reaches mu_s + growth(rested_s + t).
  /// \param held  at most mu_s + growth(rested_s). \param rate  > 0, 1/s.
  [[nodiscard]] double gives_way_s(double held, double rate, double mu_s, double rested_s) const;
};

struct PaperSettings {
  std::optional<Scatter> scatter{};
  std::optional<FirstPeak> first_peak{};
  std::optional<ContactAgeing> contact_ageing{};
};

/// S ≥ K ≥ 0.
struct Coefficients {
  double mu_s = 0.0;
  double mu_k = 0.0;
};

/// One effect with its own state and its own random stream.
class PaperEffect {
 public:
  virtual ~PaperEffect() = default;

  /// Name of the effect in scenes.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// Returns to the first contact.
  /// \param seed  of the scene's run; the effect adds its name to it.
  virtual void restart(std::uint64_t seed) = 0;
  /// A new contact; keeps S ≥ K ≥ 0. Does not allocate.
  virtual void renew(Coefficients& contact) = 0;
  /// The contact has given way.
  virtual void slipped() {}
};

[[nodiscard]] std::unique_ptr<PaperEffect> make_scatter(const Scatter& settings);
[[nodiscard]] std::unique_ptr<PaperEffect> make_first_peak(const FirstPeak& settings);

class Paper {
 public:
  /// \param mean  S and K before the effects.
  Paper(const PaperSettings& settings, const Coefficients& mean);

  /// Begins a test anew; renew() follows.
  void restart(std::uint64_t seed);
  /// The sled meets a new place.
  void renew();
  /// Tells that the contact gave way after this time at rest: S becomes the limit that it had then.
  void slipped(double rested_s);
  /// Static limit of the contact after this time at rest.
  [[nodiscard]] double static_limit(double rested_s) const noexcept {
    return ageing_ ? now_.mu_s + ageing_->growth(rested_s) : now_.mu_s;
  }
  /// Its derivatives, as those of ContactAgeing::growth().
  [[nodiscard]] double static_limit_slope_per_s(double rested_s) const noexcept {
    return ageing_ ? ageing_->growth_rate_per_s(rested_s) : 0.0;
  }
  [[nodiscard]] double static_limit_bend_per_s2(double rested_s) const noexcept {
    return ageing_ ? ageing_->growth_bend_per_s2(rested_s) : 0.0;
  }
  /// Increase of S by contact ageing after this time at rest.
  [[nodiscard]] double growth(double rested_s) const noexcept {
    return ageing_ ? ageing_->growth(rested_s) : 0.0;
  }
  /// Time until a force that rises from `held` at `rate` (> 0, 1/s) exceeds the static limit, after this time
  /// at rest.
  [[nodiscard]] double gives_way_s(double held, double rate, double rested_s) const {
    return ageing_ ? ageing_->gives_way_s(held, rate, now_.mu_s, rested_s) : (now_.mu_s - held) / rate;
  }

  [[nodiscard]] const Coefficients& now() const noexcept { return now_; }
  /// Sliding distance to a new contact, m; infinite if the paper is uniform.
  [[nodiscard]] double correlation_length_m() const noexcept { return correlation_length_m_; }

 private:
  Coefficients mean_;
  Coefficients now_;
  double correlation_length_m_ = std::numeric_limits<double>::infinity();
  std::optional<ContactAgeing> ageing_;
  std::vector<std::unique_ptr<PaperEffect>> effects_;
};

}  // namespace stickslip::sim
