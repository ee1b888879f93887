/// \file
/// The friction law as a picture, and in words.
#pragma once

#include "report/plot/figure.hpp"

#include "core/law/friction_law.hpp"

namespace stickslip::cli {

/// "S depends on the time at rest, K is constant".
[[nodiscard]] const char* in_words(const law::FrictionLaw& found);

/// S against the time at rest and K against the speed, each with its tests, as a constant and as a line.
[[nodiscard]] plot::Figure law_figure(const law::FrictionLaw& found);

}  // namespace stickslip::cli
