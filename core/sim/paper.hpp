/// \file
/// The paper: S and K of the present contact.
///
///     Paper paper{settings, {0.35, 0.30}};
///     paper.restart(seed);
///     paper.renew();              // The sled has come to rest on a new place:
///     paper.static_limit(0.1);    // what holds it there after 0.1 s of rest, and
///     paper.now().mu_k;           // what it will slide with.
///
/// A contact begins at the start, whenever the sliding sled comes to the belt's speed, and whenever it has
/// slid a correlation length. Its S and K stay until the next one begins; only ageing raises S.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace stickslip::sim {

/// Effect `scatter` (motion): S and K vary from contact to contact.
struct Scatter {
  /// Coefficient of variation of S − K, which is log-normal with the scene's S − K as its mean: never S < K.
  double delta_mu_cv = 0.0;
  double mu_k_sd = 0.0;  ///< Standard deviation of K, which is normal; a K below zero becomes zero.
  /// Sliding distance after which the sled is on a new contact, > 0.
  double correlation_length_m = std::numeric_limits<double>::infinity();
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

  /// β log₁₀(1 + t/t₀) after this time t ≥ 0 at rest.
  [[nodiscard]] double growth(double rested_s) const noexcept;
  /// Derivative of growth(); decreases monotonically.
  [[nodiscard]] double growth_rate_per_s(double rested_s) const noexcept;
  /// Absolute value of the second derivative of growth(); decreases monotonically.
  [[nodiscard]] double growth_bend_per_s2(double rested_s) const noexcept;
  /// First t ≥ 0, s, at which held + rate · t rises through mu_s + growth(rested_s + t).
  /// \param held  at most mu_s + growth(rested_s). \param rate  > 0, 1/s.
  [[nodiscard]] double gives_way_s(double held, double rate, double mu_s, double rested_s) const;
};

/// Effects that act on the paper; absent ones do not.
struct PaperSettings {
  std::optional<Scatter> scatter{};
  std::optional<FirstPeak> first_peak{};
  std::optional<ContactAgeing> contact_ageing{};
};

/// Static and kinetic coefficient, S ≥ K ≥ 0.
struct Coefficients {
  double mu_s = 0.0;
  double mu_k = 0.0;
};

/// Effect that changes S and K of new contacts. It has its own state and its own random stream. Call
/// restart() first.
class PaperEffect {
 public:
  virtual ~PaperEffect() = default;

  /// Name of the effect in scenes.
  [[nodiscard]] virtual std::string_view name() const noexcept = 0;
  /// Returns to the state before the first contact.
  /// \param seed  of the scene's run; the effect's random stream is that of stream_seed(seed, name()).
  virtual void restart(std::uint64_t seed) = 0;
  /// Changes S and K of a new contact, which are the means as changed by the effects before. Keeps S ≥ K ≥ 0.
  /// Does not allocate.
  virtual void renew(Coefficients& contact) = 0;
  /// Tells that the contact has given way.
  virtual void slipped() {}
};

[[nodiscard]] std::unique_ptr<PaperEffect> make_scatter(const Scatter& settings);
[[nodiscard]] std::unique_ptr<PaperEffect> make_first_peak(const FirstPeak& settings);

/// S and K of the present contact, after all effects. Call restart() and renew() first.
class Paper {
 public:
  /// \param mean  S and K before the effects.
  Paper(const PaperSettings& settings, const Coefficients& mean);

  /// Returns to the start of a test, with the random numbers of `seed`. now() is valid only after renew().
  void restart(std::uint64_t seed);
  /// Begins a new contact.
  void renew();
  /// Tells that the contact gave way after this time at rest: S of now() becomes the limit that it had then,
  /// ageing included.
  void slipped(double rested_s);
  /// Static limit of a contact that has not yet given way, after this time at rest: S with ageing.
  [[nodiscard]] double static_limit(double rested_s) const noexcept {
    return ageing_ ? now_.mu_s + ageing_->growth(rested_s) : now_.mu_s;
  }
  /// Derivative of static_limit().
  [[nodiscard]] double static_limit_slope_per_s(double rested_s) const noexcept {
    return ageing_ ? ageing_->growth_rate_per_s(rested_s) : 0.0;
  }
  /// Absolute value of the second derivative of static_limit().
  [[nodiscard]] double static_limit_bend_per_s2(double rested_s) const noexcept {
    return ageing_ ? ageing_->growth_bend_per_s2(rested_s) : 0.0;
  }
  /// Increase of S by contact ageing after this time at rest.
  [[nodiscard]] double growth(double rested_s) const noexcept {
    return ageing_ ? ageing_->growth(rested_s) : 0.0;
  }
  /// Time, s, until a force that rises from `held` at `rate` rises through the static limit, if the contact
  /// has rested for rested_s now. A force at the limit does not count while ageing raises the limit faster.
  /// \param held  coefficient, at most static_limit(rested_s). \param rate  > 0, 1/s.
  [[nodiscard]] double gives_way_s(double held, double rate, double rested_s) const {
    return ageing_ ? ageing_->gives_way_s(held, rate, now_.mu_s, rested_s) : (now_.mu_s - held) / rate;
  }

  [[nodiscard]] const Coefficients& now() const noexcept { return now_; }
  /// Sliding distance from one contact to the next; infinite without scatter.
  [[nodiscard]] double correlation_length_m() const noexcept { return correlation_length_m_; }

 private:
  Coefficients mean_;
  Coefficients now_;
  double correlation_length_m_ = std::numeric_limits<double>::infinity();
  std::optional<ContactAgeing> ageing_;
  std::vector<std::unique_ptr<PaperEffect>> effects_;
};

}  // namespace stickslip::sim
