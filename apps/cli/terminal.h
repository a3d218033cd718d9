// The person at the terminal: progress for what takes long, and the wish to stop.
#pragma once

#include <pelage/progress.h>

#include <chrono>
#include <string>
#include <string_view>

namespace pelage::cli {

/// Shows one line on standard error, from one second on, while it lives: stage, bar, share and time left. Shows nothing
/// where standard error is no terminal. Interrupts (Ctrl-C, SIGTERM) cancel the work through the callback, so that no
/// half-written file stays behind; see interrupted_by().
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// To hand to the library; valid while this object lives.
  Progress callback();

 private:
  using Clock = std::chrono::steady_clock;
  bool report(std::string_view stage, double share);
  void draw(double share, Clock::time_point now);
  void clear();

  const bool terminal_;
  const Clock::time_point start_;
  Clock::time_point stage_start_, drawn_;
  std::string stage_;
  bool visible_ = false;
};

/// The signal that asked the running work to stop, 0 for none.
int interrupted_by();

}  // namespace pelage::cli
