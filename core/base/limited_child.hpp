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
  /// Processor time of the child, not wall time: a child that waits is not ended. 0: no limit.
  std::chrono::milliseconds processor_time{0};
  /// Bytes of address space that the child may map in addition to what it has mapped when the question comes.
  /// 0: nothing in addition. The memory file does not count. No limit under a sanitizer.
  std::uint64_t memory = 0;
};

/// Limits for reading a file of `size` bytes: 10 s plus 1 s per MB; 512 MB plus 20 times its size. An hour at
/// 350 scans/s (3 MB) takes 0.2 s and 60 MB.
[[nodiscard]] WorkLimits limits_for_file(std::uint64_t size);

/// Bytes of an answer at most: a damaged or malicious file may make the child say anything. The longest of
/// this program, verdicts, have some hundred bytes for each gap and each damaged place: ten million of them.
inline constexpr std::uint64_t kLongestAnswer = 1'000'000'000;

/// Work of the child: returns a short answer to a question and writes long data into the memory file, a
/// descriptor of a file that is empty when the question comes. An exception ends the child.
using ChildWork = std::function<std::string(std::string_view question, int memory_file)>;

/// Executable that calls answer_questions(), not searched in PATH, and its arguments after argv[0].
struct ChildProgram {
  std::string path;
  std::vector<std::string> arguments;
};

/// Main loop of a ChildProgram. Standard input is a socket, from which it reads questions and to which it
/// writes the answers; standard output is the memory file. The process ends when its parent ends, or the
/// thread of the parent that started it.
[[noreturn]] void answer_questions(const ChildWork& work);

/// Child process that starts at the first question and answers any number of them; if it has died, the next
/// question starts another. It ends with this object, and with the thread whose question started it.
/// Thread-bound; move-constructible.
class LimitedChild {
 public:
  /// The first question starts the child, by posix_spawn: this process may have several threads.
  explicit LimitedChild(ChildProgram program) : start_(std::move(program)) {}
  /// The first question starts the child, by fork: this process must then have one thread only, as whenever a
  /// child that died is replaced.
  explicit LimitedChild(ChildWork work) : start_(std::move(work)) {}
  ~LimitedChild() { end(); }
  LimitedChild(LimitedChild&& other) noexcept
      : start_(std::move(other.start_)),
        child_(std::exchange(other.child_, 0)),
        socket_(std::move(other.socket_)),
        memory_file_(std::move(other.memory_file_)),
        asked_(std::exchange(other.asked_, std::nullopt)) {}
  LimitedChild& operator=(LimitedChild&&) = delete;

  /// Asks the child and waits for the answer of its ChildWork.
  /// \param given_up  called ten times a second and at each signal during the wait; true gives up the
  ///        question and ends the child. Empty: never.
  /// Errors, whose messages do not name the question: kUsage with Error::worker_died if the child died, by a
  /// limit, an exception or a signal, or was ended since its answer was longer than kLongestAnswer;
  /// kInterrupted if given up; kFailure if the system refuses.
  [[nodiscard]] Result<std::string> ask(std::string_view question, const WorkLimits& limits,
                                        const std::function<bool()>& given_up = {});

  /// The two halves of ask(), to do other work between them. A second begin() without answer() discards the
  /// answer and its child. answer() needs a begin() before it that succeeded (contract). Errors of begin():
  /// kFailure if no child can be started; of answer(): those of ask().
  [[nodiscard]] Result<void> begin(std::string_view question, const WorkLimits& limits);
  [[nodiscard]] Result<std::string> answer(const std::function<bool()>& given_up = {});

  /// Path of the memory file, as the latest answer left it; there is none before the first question. This
  /// process can open it until the next question, which empties it, or the end of this object.
  [[nodiscard]] std::string memory_file() const;

 private:
  [[nodiscard]] Result<void> start();
  /// Waits until the socket can be read: true, also where the child died.
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
