#include <array>
#include <string_view>
#include <utility>

#include "core/sim/scene_file_parts.hpp"

namespace stickslip::sim {

using base::Dimension;
using base::Limits;
using base::Settings;

namespace {

constexpr double kFastestLoadCell_Hz = 1e5;
constexpr double kLargestDampingRatio = 10.0;

model::AntiAlias read_anti_alias(Settings effect, const Scene& scene) {
  enum class Kind { kRc, kButterworth };
  constexpr std::array<std::pair<std::string_view, Kind>, 2> kKinds{
      {{"rc", Kind::kRc}, {"butterworth", Kind::kButterworth}}};
  model::AntiAlias filter;
  // Above half the scan rate it would keep no alias away.
  filter.cutoff_Hz =
      effect.quantity("cutoff", Dimension::kFrequency, Limits::above_up_to(0.0, scene.scan_rate_Hz / 2.0));
  if (effect.choice<Kind>("kind", kKinds) == Kind::kButterworth) {
    filter.order = static_cast<int>(effect.integer("order", 1, model::AntiAlias::kHighestOrder));
  } else if (effect.has("order")) {
    effect.refuse("order", "must not stand beside kind = \"rc\", whose order is 1");
  }
  return filter;
}

}  // namespace

void read_transducer_effects(Settings effects, Scene& scene) {
  if (lists(effects, "load_cell")) {
    Settings effect = effects.table("load_cell");
    model::LoadCellDynamics cell;
    cell.frequency_Hz =
        effect.quantity("frequency", Dimension::kFrequency, Limits::above_up_to(0.0, kFastestLoadCell_Hz));
    cell.damping_ratio = effect.quantity("damping_ratio", Dimension::kDimensionless,
                                         Limits::above_up_to(0.0, kLargestDampingRatio));
    scene.load_cell_dynamics = cell;
  }
  if (lists(effects, "anti_alias")) scene.anti_alias = read_anti_alias(effects.table("anti_alias"), scene);
}

}  // namespace stickslip::sim
