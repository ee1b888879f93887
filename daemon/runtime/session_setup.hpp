/// \file
/// What follows for a session and its records from the configuration and from the board that was opened.
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

/// A folder that records can be made in, by this process alone.
struct RecordFolder {
  std::vector<std::string> lacks;  ///< What its file system lacks and what follows, a sentence each.
  storage::FolderLock lock;
};

/// Makes the folder if it is absent, tries there what records need, and locks it. Errors: kFailure if no
/// record can be made there, or another daemon records into it.
[[nodiscard]] base::Result<RecordFolder> prepare_record_folder(
    const std::filesystem::path& folder, const record::FileCalls& calls = record::system_calls());

/// \param continues  where the session before this one ended. Errors: kUsage.
[[nodiscard]] base::Result<SessionSettings> session_settings(const io::DaemonConfig& config,
                                                             const drivers::OpenedBoard& opened,
                                                             const SessionEnd& continues);

/// What all records of the session begin with. \param realtime  what the kernel granted.
[[nodiscard]] record::RecordHeader record_header(const io::DaemonConfig& config,
                                                 const SessionSettings& settings, const daq::BoardInfo& board,
                                                 const std::string& realtime);

/// Do the scans come often enough for the tester as it is planned or characterised? Errors: kUsage where they
/// cannot tell slips, but for a replay.
[[nodiscard]] base::Result<estimate::SamplingVerdict> check_sampling(const io::DaemonConfig& config,
                                                                     const SessionSettings& settings);

}  // namespace stickslip::runtime
