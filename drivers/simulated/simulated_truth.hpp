/// \file
/// The truth about the simulated board's scans, found again by simulating without scans.
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

/// Answers for the repetition that shares most scans with the window; where the window cuts it, modes
/// and cycles are cut too. Nothing for a window without scans or behind the end of the list.
/// \param method  as for sim::scene_truth().
[[nodiscard]] std::shared_ptr<const model::TruthSource> make_simulated_truth(
    std::shared_ptr<const Playlist> playlist, model::Method method = {});

}  // namespace stickslip::drivers
