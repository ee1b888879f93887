/// \file
/// Makes reports, reads traces and searches records, one of each at a time, in a child process, because
/// errors of HDF5 can end a process and the daemon must go on measuring.
#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>  // Boost 1.74 on GCC 12 needs it before Asio.
#include <vector>

#include <boost/asio/io_context.hpp>

#include "daemon/types/reports.hpp"

namespace stickslip::page {

/// Path of the program `stickslip` in the folder of the running program.
[[nodiscard]] std::string program_beside_this();

/// Main thread.
class ReportJobs final : public daemon::Reports {
 public:
  struct Parts {
    boost::asio::io_context& io;                                   ///< Outlives this object.
    std::filesystem::path folder;                                  ///< The record folder.
    std::string program;                                           ///< Path of `stickslip`.
    std::chrono::milliseconds longest = std::chrono::seconds{60};  ///< Time after which the child is killed.
    std::size_t largest = std::size_t{64} << 20U;  ///< Most bytes of its output, which is held in memory.
  };
  explicit ReportJobs(Parts parts);
  /// Kills the child; the answer is not called.
  ~ReportJobs() override;
  ReportJobs(const ReportJobs&) = delete;
  ReportJobs& operator=(const ReportJobs&) = delete;

  void make(std::span<const daemon::ReportedBatch> batches, daemon::ReportForm form, std::string_view pool,
            Answer answer) override;
  void trace(const daemon::TraceRequest& request, Answer answer) override;
  void report(const std::filesystem::path& record, daemon::ReportForm form, Answer answer) override;
  void find(const daemon::RecordSearch& search, Answer answer) override;
  [[nodiscard]] base::Result<std::filesystem::path> record(const std::string& name) const override;

 private:
  struct Job;
  /// One job at a time, and what is said of it.
  struct Slot {
    std::string_view what;
    std::string_view if_slow;    ///< What helps where it took too long.
    std::string_view if_large;   ///< What helps where it is too large.
    std::size_t largest;         ///< Most bytes of a file that the child writes; 0: no limit.
    int status_of_nothing = 0;   ///< Exit status of the child if its answer is whole but empty.
    std::unique_ptr<Job> job{};  ///< Null: none is under way.
  };
  void start(Slot& slot, std::vector<std::string> arguments, Answer answer,
             std::vector<std::string> variables = {});
  void ended(Slot& slot);

  Parts parts_;
  Slot reports_;
  Slot traces_;
  Slot searches_;
};

}  // namespace stickslip::page
