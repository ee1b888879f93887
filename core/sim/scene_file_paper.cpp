#include <array>
#include <string_view>
#include <utility>

#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {

using base::Dimension;
using base::Limits;
using base::Settings;

namespace {

constexpr double kLargestScatter = 0.6;   // Real paper scatters by 22–55 %.
constexpr double kFinestPaper_m = 1e-6;   // Below the thickness of a fibre,
constexpr double kCoarsestPaper_m = 1.0;  // above the length of a sheet.
constexpr double kShortestCutoff_s = 1e-9;
constexpr double kLongestCutoff_s = 1e8;

Scatter read_scatter(Settings effect) {
  Scatter scatter;
  scatter.delta_mu_cv =
      effect.quantity("delta_mu_cv", Dimension::kDimensionless, Limits::between(0.0, kLargestScatter));
  scatter.mu_k_sd =
      effect.quantity("mu_k_sd", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient), 0.0);
  scatter.correlation_length_m = effect.quantity("correlation_length", Dimension::kLength,
                                                 Limits::between(kFinestPaper_m, kCoarsestPaper_m), 0.001);
  return scatter;
}

FirstPeak read_first_peak(Settings effect) {
  FirstPeak peak;
  peak.change = effect.quantity("change", Dimension::kDimensionless,
                                Limits::between(-kLargestCoefficient, kLargestCoefficient));
  peak.sd = effect.quantity("sd", Dimension::kDimensionless, Limits::between(0.0, kLargestCoefficient), 0.0);
  return peak;
}

ContactAgeing read_contact_ageing(Settings effect) {
  ContactAgeing ageing;
  ageing.per_decade = effect.quantity("per_decade", Dimension::kDimensionless, Limits::between(0.0, 1.0));
  ageing.cutoff_s = effect.quantity("cutoff", Dimension::kTime,
                                    Limits::between(kShortestCutoff_s, kLongestCutoff_s), 0.001);
  return ageing;
}

OnsetConvention read_onset_convention(Settings effect) {
  constexpr std::array<std::pair<std::string_view, OnsetConvention>, 2> kNames{
      {{"spring", OnsetConvention::kSpring}, {"spring-and-damper", OnsetConvention::kSpringAndDamper}}};
  return effect.choice<OnsetConvention>("force", kNames);
}

}  // namespace

void read_paper_effects(Settings effects, Scene& scene) {
  if (lists(effects, "scatter")) scene.paper.scatter = read_scatter(effects.table("scatter"));
  if (lists(effects, "first_peak")) scene.paper.first_peak = read_first_peak(effects.table("first_peak"));
  if (lists(effects, "contact_ageing")) {
    scene.paper.contact_ageing = read_contact_ageing(effects.table("contact_ageing"));
  }
  if (lists(effects, "onset_convention")) {
    scene.onset_convention = read_onset_convention(effects.table("onset_convention"));
  }
}

}  // namespace stickslip::sim
