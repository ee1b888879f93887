/// \file
/// Reports, made one at a time by a process of its own: HDF5's errors can end a process, and the daemon
/// measures meanwhile.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.

#include <boost/asio/io_context.hpp>

#include "daemon/types/reports.hpp"

namespace stickslip::page {

/// The command line's program beside this one, which is not asked what it is called now.
[[nodiscard]] std::string program_beside_this();

/// Main thread.
class ReportDesk final : public daemon::Reports {
 public:
  struct Parts {
    boost::asio::io_context& io;                                   ///< Outlives this object.
    std::filesystem::path folder;                                  ///< Of the records.
    std::string program;                                           ///< That knows `report` and `compare`.
    std::chrono::milliseconds longest = std::chrono::seconds{60};  ///< Then it is ended.
    std::size_t largest = std::size_t{64} << 20U;                  ///< Bytes. The answer is held in memory.
  };
  explicit ReportDesk(Parts parts);
  /// Ends what is being made; nobody is told.
  ~ReportDesk() override;
  ReportDesk(const ReportDesk&) = delete;
  ReportDesk& operator=(const ReportDesk&) = delete;

  void make(std::span<const daemon::ReportedBatch> batches, daemon::ReportForm form, Answer answer) override;

 private:
  struct Job;
  void ended();

  Parts parts_;
  std::unique_ptr<Job> job_;  ///< Null: none is being made.
};

}  // namespace stickslip::page
