#include "daemon/page/report_jobs.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
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

/// Option of `stickslip` that writes a report in this form to its standard output.
std::string option_of(daemon::ReportForm form) {
  switch (form) {
    case daemon::ReportForm::kPage:
      break;
    case daemon::ReportForm::kCsv:
      return "--csv=-";
    case daemon::ReportForm::kJson:
      return "--json";
  }
  return "--output=-";
}

/// Where the child finds the place of the index of records (catalogue::index_place()), as this process would.
std::vector<std::string> places() {
  std::vector<std::string> variables;
  for (const char* const name : {"XDG_CACHE_HOME", "HOME"}) {
    if (const char* const value = std::getenv(name)) variables.push_back(fmt::format("{}={}", name, value));
  }
  return variables;
}

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
  arguments.push_back(option_of(form));
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
               .if_large = "ask for csv or json, or `stickslip report --batch` makes it",
               .largest = parts_.largest},
      traces_{.what = "trace",
              .if_slow = "`stickslip export --json` takes its time",
              .if_large = "ask for fewer points",
              .largest = parts_.largest},
      // The child writes the index, too; its answer is small.
      searches_{.what = "search",
                .if_slow = "ask again: the index keeps what was read",
                .if_large = "",
                .largest = 0,
                .status_of_nothing = 3} {}

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

void ReportJobs::report(const std::filesystem::path& record, daemon::ReportForm form, Answer answer) {
  start(reports_, {"report", option_of(form), std::filesystem::absolute(record).string()}, std::move(answer));
}

void ReportJobs::find(const daemon::RecordSearch& search, Answer answer) {
  std::vector<std::string> arguments{"find", "--json", "--sort=date", "--reverse",
                                     fmt::format("--most={}", search.most)};
  for (const auto& [option, value] : search.conditions)
    arguments.push_back(fmt::format("--{}={}", option, value));
  arguments.push_back(std::filesystem::absolute(parts_.folder).string());
  start(searches_, std::move(arguments), std::move(answer), places());
}

base::Result<std::filesystem::path> ReportJobs::record(const std::string& name) const {
  std::error_code error;
  const std::string folder = std::filesystem::canonical(parts_.folder, error).string();
  const std::filesystem::path whole = error ? "" : std::filesystem::canonical(folder + "/" + name, error);
  // What leads elsewhere by "..", a link or from the root on has another name when it is resolved.
  if (!error && whole.native() == folder + "/" + name && whole.extension() == ".h5") return whole;
  return base::usage_error("there is no record {}; GET /v1/records lists them", base::one_line(name));
}

void ReportJobs::start(Slot& slot, std::vector<std::string> arguments, Answer answer,
                       std::vector<std::string> variables) {
  if (slot.job) {
    answer(tl::unexpected(base::Error{
        base::ErrorKind::kBusy,
        fmt::format("another {} is being made, one at a time; ask again in a moment", slot.what)}));
    return;
  }
  using std::chrono::ceil;
  const io::ChildLimits limits{ceil<std::chrono::seconds>(parts_.longest), slot.largest, kNiceness};
  auto child =
      io::ChildProcess::start(parts_.program, std::move(arguments), {}, limits, std::move(variables));
  if (!child) return answer(tl::unexpected(child.error()));
  if (!*child) {
    return answer(base::failure("{}: there is no such program; it makes each {}: install it there",
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
  if (made->status == 0 || made->status == slot.status_of_nothing)
    return job->answer(std::move(made->output));
  if (job->took_too_long || made->status == kSignalled + SIGXCPU) {
    return job->answer(base::failure("the {} took longer than {:.3g} s and was ended; {}", slot.what,
                                     std::chrono::duration<double>(parts_.longest).count(), slot.if_slow));
  }
  if (made->status == kSignalled + SIGXFSZ) {
    return job->answer(base::failure("the {} is larger than {:.3g} MiB; {}", slot.what,
                                     static_cast<double>(slot.largest) / (1U << 20U), slot.if_large));
  }
  if (made->status > kSignalled)
    return job->answer(
        base::failure("signal {} ended the program that makes the {}", made->status - kSignalled, slot.what));
  constexpr std::string_view kName = "stickslip: ";
  std::string_view why = made->errors;
  if (why.starts_with(kName)) why.remove_prefix(kName.size());
  while (why.ends_with('\n')) why.remove_suffix(1);
  constexpr std::size_t kLongestReason = 400;
  // It names an option that the request gave as a key.
  constexpr int kWrongUsage = 2;
  if (made->status == kWrongUsage && why.starts_with("--"))
    return job->answer(base::usage_error("{}", base::one_line(why.substr(2), kLongestReason)));
  job->answer(base::failure("there is no {}: {}", slot.what, base::one_line(why, kLongestReason)));
}

}  // namespace stickslip::page
