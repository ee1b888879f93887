/// \file
/// How far a long command has come, for a person at a terminal.
#pragma once

#include <string>

namespace stickslip::cli {

/// One line on stderr, gone in the end; nothing at all if stderr is no terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::string what);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// \param done  0 … 1. \param note  behind it, such as the time that is left.
  void show(double done, const std::string& note = {});
  /// The next part, which does not tell how far it is.
  void show(const std::string& what);

 private:
  std::string what_;
  bool terminal_;
  int percent_ = -1;
  std::string note_;
};

}  // namespace stickslip::cli
