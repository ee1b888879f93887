/// \file
/// A child process that answers requests within limits of time and memory, for work that may not end, such as
/// HDF5 reading a damaged or malicious file.
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

/// Limits of one answer.
struct WorkLimits {
  std::chrono::milliseconds processor_time{0};
  /// Bytes of address space above what the child has mapped before. No limit under a sanitizer.
  std::uint64_t memory = 0;
};

/// Limits for reading a file of `size` bytes: 10 s plus 1 s per MB; 512 MB plus 20 times its size. An hour at
/// 350 scans/s (3 MB) takes 0.2 s and 60 MB.
[[nodiscard]] WorkLimits limits_for_file(std::uint64_t size);

/// Work of the child: returns a short answer to a question and writes long data into the memory file. An
/// exception ends the child.
using ChildWork = std::function<std::string(std::string_view question, int memory_file)>;

/// Executable that calls answer_questions(), with its arguments.
struct ChildProgram {
  std::string path;
  std::vector<std::string> arguments;
};

/// Main loop of a ChildProgram: reads questions from standard input and answers them; standard output is the
/// memory file. The process ends when its parent ends.
[[noreturn]] void answer_questions(const ChildWork& work);

/// Child process that starts at the first question, answers any number of them and is replaced when it dies.
/// It ends with this object, and with the thread that asked first. Thread-bound, movable.
class LimitedChild {
 public:
  /// Starts the child by posix_spawn; allowed in a process with several threads.
  explicit LimitedChild(ChildProgram program) : start_(std::move(program)) {}
  /// Starts the child by fork; allowed only while this process has one thread.
  explicit LimitedChild(ChildWork work) : start_(std::move(work)) {}
  ~LimitedChild() { end(); }
  LimitedChild(LimitedChild&& other) noexcept
      : start_(std::move(other.start_)),
        child_(std::exchange(other.child_, 0)),
        socket_(std::move(other.socket_)),
        memory_file_(std::move(other.memory_file_)),
        asked_(std::exchange(other.asked_, std::nullopt)) {}
  LimitedChild& operator=(LimitedChild&&) = delete;

  /// \param given_up  called ten times a second and at each signal; true gives up the question. Empty: never.
  /// Errors, without the file's name: kUsage if the work exceeded a limit or killed the child; kInterrupted
  /// if given up; kFailure if no child can be started.
  [[nodiscard]] Result<std::string> ask(std::string_view question, const WorkLimits& limits,
                                        const std::function<bool()>& given_up = {});

  /// The two halves of ask(), to do other work between them. A second begin() without answer() discards the
  /// answer and its child. Errors of begin(): kFailure if no child can be started.
  [[nodiscard]] Result<void> begin(std::string_view question, const WorkLimits& limits);
  [[nodiscard]] Result<std::string> answer(const std::function<bool()>& given_up = {});

  /// Memory file written by the latest answer.
  /// \return a path that this process can open until the next question.
  [[nodiscard]] std::string memory_file() const;

 private:
  [[nodiscard]] Result<void> start();
  /// \return nothing where the child died before it.
  [[nodiscard]] Result<bool> wait_for_answer(const std::function<bool()>& given_up) const;
  [[nodiscard]] tl::unexpected<Error> why_it_died(const WorkLimits& limits);
  void end() noexcept;

  std::variant<ChildProgram, ChildWork> start_;
  pid_t child_ = 0;  ///< 0: no child runs.
  Descriptor socket_;
  Descriptor memory_file_;
  std::optional<WorkLimits> asked_;  ///< Limits of the question that waits for its answer.
};

}  // namespace stickslip::base
