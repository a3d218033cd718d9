#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

namespace pelage::cli {
namespace {

std::atomic<int> g_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch it");

void note_signal(int signal) { g_signal = signal; }

// The second interrupt kills at once: SA_RESETHAND.
void install_handlers() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

std::string duration_text(double seconds) {
  const auto s = static_cast<long>(seconds + 0.5);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
  return fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

}  // namespace

int interrupted_by() { return g_signal; }

ProgressLine::ProgressLine()
    : terminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()), stage_start_(start_), drawn_(start_) {
  install_handlers();
}

ProgressLine::~ProgressLine() { clear(); }

Progress ProgressLine::callback() {
  return [this](std::string_view stage, double share) { return report(stage, share); };
}

bool ProgressLine::report(std::string_view stage, double share) {
  const Clock::time_point now = Clock::now();
  if (stage != stage_) stage_ = stage, stage_start_ = now;
  using namespace std::chrono_literals;
  if (terminal_ && now - start_ > 1s && now - drawn_ > 50ms) draw(share, now);
  return g_signal == 0;
}

void ProgressLine::draw(double share, Clock::time_point now) {
  constexpr int kWidth = 30;
  const int full = static_cast<int>(share * kWidth);
  const double spent = std::chrono::duration<double>(now - stage_start_).count();
  const std::string left = share > 0.02 && spent > 0.3 ? duration_text(spent * (1 - share) / share) + " left" : "";
  fmt::print(stderr, "\r\033[K{:<10} [{:#<{}}{:.<{}}] {:3.0f} %  {}", stage_, "", full, "", kWidth - full, 100 * share, left);
  std::fflush(stderr);
  drawn_ = now;
  visible_ = true;
}

void ProgressLine::clear() {
  if (!visible_) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
  visible_ = false;
}

}  // namespace pelage::cli
