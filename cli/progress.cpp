#include "cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace stickslip::cli {
namespace {

constexpr const char* kClearLine = "\r\x1b[K";
constexpr int kWidth = 40;

}  // namespace

ProgressBar::ProgressBar(std::string what)
    : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (terminal_) std::fputs(kClearLine, stderr);
}

void ProgressBar::show(double done, const std::string& note) {
  const int percent = static_cast<int>(done * 100.0);
  if (!terminal_ || (percent == percent_ && note == note_)) return;
  percent_ = percent;
  note_ = note;
  const int filled = percent * kWidth / 100;
  fmt::print(stderr, "{}{} [{:#<{}}{:.<{}}] {} %{}{}", kClearLine, what_, "", filled, "", kWidth - filled,
             percent, note.empty() ? "" : ", ", note);
}

void ProgressBar::show(const std::string& what) {
  if (terminal_) fmt::print(stderr, "{}{} …", kClearLine, what);
}

}  // namespace stickslip::cli
