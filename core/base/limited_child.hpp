/// \file
/// A child process that answers questions within limits: for work that may not end, as HDF5's on a file that
/// is damaged or made to deceive.
///
///     LimitedChild reader{ChildProgram{"/proc/self/exe", {"--read-files"}}};
///     const Result<std::string> answer = reader.ask(file, limits_for_file(size));
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/descriptor.hpp"
#include "core/base/result.hpp"

namespace stickslip::base {

/// What one answer may take.
struct WorkLimits {
  std::chrono::milliseconds processor_time{0};
  /// Bytes of address space above what the child has mapped before. No limit under a sanitizer.
  std::uint64_t memory = 0;
};

/// For reading a file of that size: 10 s and 1 s for each MB; 512 MB and 20 times its size. An hour at 350
/// scans/s (3 MB) takes 0.2 s and 60 MB.
[[nodiscard]] WorkLimits limits_for_file(std::uint64_t size);

/// What the child does with a question: its answer, which is short; what is long it writes into the memory
/// file. An exception ends the child.
using ChildWork = std::function<std::string(std::string_view question, int memory_file)>;

/// A program that calls answer_questions().
struct ChildProgram {
  std::string path;
  std::vector<std::string> arguments;
};

/// The loop of a ChildProgram: answers what comes from standard input; standard output is the memory file.
/// Ends the process with its parent.
[[noreturn]] void answer_questions(const ChildWork& work);

/// Starts at the first question, answers any number and is replaced when it dies. Ends with its owner, and
/// with the thread that asked first. Thread-bound, movable.
class LimitedChild {
 public:
  /// By posix_spawn: may be started by a process of many threads.
  explicit LimitedChild(ChildProgram program) : start_(std::move(program)) {}
  /// A copy of this process: only while it has one thread.
  explicit LimitedChild(ChildWork work) : start_(std::move(work)) {}
  ~LimitedChild() { end(); }
  LimitedChild(LimitedChild&& other) noexcept
      : start_(std::move(other.start_)),
        child_(std::exchange(other.child_, 0)),
        socket_(std::move(other.socket_)),
        memory_file_(std::move(other.memory_file_)),
        asked_(std::exchange(other.asked_, std::nullopt)) {}
  LimitedChild& operator=(LimitedChild&&) = delete;

  /// \param given_up  asked ten times a second and at each signal; empty: never given up.
  /// Errors, without the file's name: kUsage if the work broke a limit or killed the child; kInterrupted if
  /// it was given up; kFailure if there can be no child.
  [[nodiscard]] Result<std::string> ask(std::string_view question, const WorkLimits& limits,
                                        const std::function<bool()>& given_up = {});

  /// The two halves of ask(): other work can be done between them. An answer that nobody took is lost at the
  /// next question, and its child with it. Errors of begin(): kFailure if there can be no child.
  [[nodiscard]] Result<void> begin(std::string_view question, const WorkLimits& limits);
  [[nodiscard]] Result<std::string> answer(const std::function<bool()>& given_up = {});

  /// What the latest answer left there. \return a path that this process can open until the next question.
  [[nodiscard]] std::string memory_file() const;

 private:
  [[nodiscard]] Result<void> start();
  /// \return nothing where the child died before it.
  [[nodiscard]] Result<bool> wait_for_answer(const std::function<bool()>& given_up) const;
  [[nodiscard]] tl::unexpected<Error> why_it_died(const WorkLimits& limits);
  void end() noexcept;

  std::variant<ChildProgram, ChildWork> start_;
  pid_t child_ = 0;  ///< 0: there is none.
  Descriptor socket_;
  Descriptor memory_file_;
  std::optional<WorkLimits> asked_;  ///< Limits of the question that waits for its answer.
};

}  // namespace stickslip::base
