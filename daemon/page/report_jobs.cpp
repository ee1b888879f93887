#include "daemon/page/report_jobs.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <system_error>
#include <vector>

#include "io/child_process.hpp"
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>

#include "core/base/contract.hpp"
#include "core/base/wording.hpp"

namespace stickslip::page {
namespace {

/// Niceness of the child: acquisition and all other threads have precedence.
constexpr int kNiceness = 10;
constexpr int kSignalled = 128;  // As ChildAnswer counts.

/// Arguments for `stickslip`, which writes the report to its standard output.
std::vector<std::string> arguments_for(std::span<const daemon::ReportedBatch> batches,
                                       daemon::ReportForm form, std::string_view pool,
                                       const std::filesystem::path& folder) {
  std::vector<std::string> arguments;
  if (batches.size() == 1) {
    arguments = {"report", "--batch=" + batches[0].id};
  } else {
    arguments = {"compare", "--batch-a=" + batches[0].id, "--label-a=" + batches[0].label,
                 "--batch-b=" + batches[1].id, "--label-b=" + batches[1].label};
  }
  if (!pool.empty()) arguments.push_back(fmt::format("--pool={}", pool));
  switch (form) {
    case daemon::ReportForm::kPage:
      arguments.emplace_back("--output=-");
      break;
    case daemon::ReportForm::kCsv:
      arguments.emplace_back("--csv=-");
      break;
    case daemon::ReportForm::kJson:
      arguments.emplace_back("--json");
      break;
  }
  arguments.push_back(std::filesystem::absolute(folder).string());
  return arguments;
}

}  // namespace

std::string program_beside_this() {
  std::error_code error;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", error);
  return (own.parent_path() / "stickslip").string();
}

struct ReportJobs::Job {
  io::ChildProcess child;
  boost::asio::posix::stream_descriptor end;
  boost::asio::steady_timer patience;
  Answer answer;
  bool took_too_long = false;
};

ReportJobs::ReportJobs(Parts parts)
    : parts_(std::move(parts)),
      reports_{.what = "report",
               .if_slow = "`stickslip report --batch` takes its time",
               .if_large = "ask for csv or json, or `stickslip report --batch` makes it"},
      traces_{.what = "trace",
              .if_slow = "`stickslip export --json` takes its time",
              .if_large = "ask for fewer points"} {}

ReportJobs::~ReportJobs() = default;

void ReportJobs::make(std::span<const daemon::ReportedBatch> batches, daemon::ReportForm form,
                      std::string_view pool, Answer answer) {
  STICKSLIP_EXPECTS(batches.size() == 1 || batches.size() == 2);
  start(reports_, arguments_for(batches, form, pool, parts_.folder), std::move(answer));
}

void ReportJobs::trace(const daemon::TraceRequest& request, Answer answer) {
  std::vector<std::string> arguments{"export", "--json", fmt::format("--points={}", request.points)};
  if (request.from_s) arguments.push_back(fmt::format("--from={}", *request.from_s));
  if (request.to_s) arguments.push_back(fmt::format("--to={}", *request.to_s));
  arguments.push_back(std::filesystem::absolute(request.record).string());
  start(traces_, std::move(arguments), std::move(answer));
}

void ReportJobs::start(Slot& slot, std::vector<std::string> arguments, Answer answer) {
  if (slot.job) {
    answer(tl::unexpected(base::Error{
        base::ErrorKind::kBusy,
        fmt::format("another {} is being made, one at a time; ask again in a moment", slot.what)}));
    return;
  }
  using std::chrono::ceil;
  const io::ChildLimits limits{ceil<std::chrono::seconds>(parts_.longest), parts_.largest, kNiceness};
  auto child = io::ChildProcess::start(parts_.program, std::move(arguments), {}, limits);
  if (!child) return answer(tl::unexpected(child.error()));
  if (!*child) {
    return answer(base::failure("{}: there is no such program; it makes the {}s: install it there",
                                parts_.program, slot.what));
  }
  const record::Descriptor end = (*child)->ended();
  // Asio closes its own.
  const int own = ::fcntl(end.get(), F_DUPFD_CLOEXEC, 0);
  if (own < 0) return answer(base::failure("the end of {} cannot be waited for", parts_.program));
  slot.job = std::make_unique<Job>(Job{**std::move(child),
                                       {parts_.io, own},
                                       boost::asio::steady_timer{parts_.io, parts_.longest},
                                       std::move(answer)});
  slot.job->end.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                           [this, &slot](boost::system::error_code error) {
                             if (!error) ended(slot);
                           });
  slot.job->patience.async_wait([&slot, job = slot.job.get()](boost::system::error_code error) {
    // The job may have ended after the timer expired; another job may run now.
    if (error || slot.job.get() != job) return;
    job->took_too_long = true;
    job->child.end();
  });
}

void ReportJobs::ended(Slot& slot) {
  const std::unique_ptr<Job> job = std::move(slot.job);
  base::Result<io::ChildAnswer> made = job->child.wait();
  if (!made) return job->answer(tl::unexpected(made.error()));
  if (made->status == 0) return job->answer(std::move(made->output));
  if (job->took_too_long || made->status == kSignalled + SIGXCPU) {
    return job->answer(base::failure("the {} took longer than {:.3g} s and was ended; {}", slot.what,
                                     std::chrono::duration<double>(parts_.longest).count(), slot.if_slow));
  }
  if (made->status == kSignalled + SIGXFSZ) {
    return job->answer(base::failure("the {} is larger than {:.3g} MiB; {}", slot.what,
                                     static_cast<double>(parts_.largest) / (1U << 20U), slot.if_large));
  }
  if (made->status > kSignalled)
    return job->answer(
        base::failure("signal {} ended the program that makes the {}", made->status - kSignalled, slot.what));
  constexpr std::string_view kName = "stickslip: ";
  std::string_view why = made->errors;
  if (why.starts_with(kName)) why.remove_prefix(kName.size());
  while (why.ends_with('\n')) why.remove_suffix(1);
  constexpr std::size_t kLongestReason = 400;
  job->answer(base::failure("there is no {}: {}", slot.what, base::one_line(why, kLongestReason)));
}

}  // namespace stickslip::page
