/// \file
/// Derives the settings of a session and the header of its records from the configuration and the opened
/// board.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/config.hpp"

#include "core/base/result.hpp"
#include "core/estimate/sampling.hpp"
#include "core/record/file_calls.hpp"
#include "core/record/record.hpp"
#include "daemon/runtime/session.hpp"
#include "daemon/storage/folder_lock.hpp"

namespace stickslip::runtime {

/// A record folder that is writable and locked by this process.
struct RecordFolder {
  /// Features that its file system lacks, each a sentence with the consequence.
  std::vector<std::string> lacks;
  storage::FolderLock lock;
};

/// Makes the folder if it is absent, tests its file system for what records need, and locks it. Errors:
/// kFailure if records cannot be made there, or another daemon holds the lock.
[[nodiscard]] base::Result<RecordFolder> prepare_record_folder(
    const std::filesystem::path& folder, const record::FileCalls& calls = record::system_calls());

/// \param continues  where the previous session ended. Errors: kUsage.
[[nodiscard]] base::Result<SessionSettings> session_settings(const io::DaemonConfig& config,
                                                             const drivers::OpenedBoard& opened,
                                                             const SessionEnd& continues);

/// The header of all records of the session. \param realtime  the real-time settings in force.
[[nodiscard]] record::RecordHeader record_header(const io::DaemonConfig& config,
                                                 const SessionSettings& settings, const daq::BoardInfo& board,
                                                 const std::string& realtime);

/// Checks the scan rate against the oscillation of the tester, as planned or characterised. Errors: kUsage if
/// the rate is too low to detect slips, except for a replay.
[[nodiscard]] base::Result<estimate::SamplingVerdict> check_sampling(const io::DaemonConfig& config,
                                                                     const SessionSettings& settings);

}  // namespace stickslip::runtime
