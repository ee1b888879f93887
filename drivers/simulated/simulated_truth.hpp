/// \file
/// Truth about the simulated board's scans, computed again from the scenes.
#pragma once

#include <filesystem>
#include <memory>

#include "core/model/method.hpp"
#include "core/model/truth.hpp"
#include "drivers/simulated/playlist.hpp"

namespace stickslip::drivers {

/// Makes times relative to the window's first scan and drops what lies outside of the window.
/// \param scratch_folder  of the tables (base::LongColumn); empty: in memory.
void move_into_window(model::TestTruth& truth, double window_start_s, double window_length_s,
                      const std::filesystem::path& scratch_folder = {});

/// Truth source for the simulated board. It returns the truth of the repetition that shares most scans with
/// the window, with modes and cycles limited to the window; nullopt for a window without scans or after the
/// end of the list.
/// \param method  as for sim::scene_truth().
[[nodiscard]] std::shared_ptr<const model::TruthSource> make_simulated_truth(
    std::shared_ptr<const Playlist> playlist, model::Method method = {});

}  // namespace stickslip::drivers
