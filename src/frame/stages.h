// Time, memory and progress of the stages of a frame.
#pragma once

#include <pelage/progress.h>
#include <pelage/render.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

/// What a stage reports when it is done.
struct StageWork {
  std::uint64_t items = 0;  ///< in the stage's unit
  std::uint64_t bytes = 0;  ///< that its results hold
};

/// Runs stages one after another and keeps their statistics. A stage that runs once for every band of a picture, or frame
/// of several that make one, or view of several, has one row: times and items add up, bytes are the largest of a run.
class Stages {
 public:
  explicit Stages(Progress progress) : progress_(std::move(progress)) {}

  /// The stages from now on are those of band `band` of `count`: their progress is told as a share of all bands.
  void set_band(int band, int count) { band_ = band, band_count_ = count; }
  /// … and the bands are those of frame `pass` of `count` that make one picture.
  void set_pass(int pass, int count) { pass_ = pass, pass_count_ = count; }
  /// … and the picture is what view `view` of `count` sees, where they are made one after the other.
  void set_view(std::size_t view, std::size_t count) { view_ = view, view_count_ = count; }

  /// Calls work(progress) → StageWork as stage `name`. Throws Error when the listener cancels.
  template <class Work>
  void run(const char* name, const char* unit, const Work& work) {
    tell(name, 0);
    const auto start = std::chrono::steady_clock::now();
    const StageWork done = work(Progress([this, name](std::string_view, double share) { return report(name, share); }));
    add(name, unit, done, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    tell(name, 1);
  }

  /// A row for what was there before: no time.
  void note(const char* name, const char* unit, const StageWork& work) { add(name, unit, work, 0); }

  std::vector<StageStat> take() { return std::move(stats_); }

 private:
  bool report(const char* name, double share) const;
  void tell(const char* name, double share) const;
  void add(const char* name, const char* unit, const StageWork& work, double seconds);

  Progress progress_;
  std::vector<StageStat> stats_;
  int band_ = 0, band_count_ = 1, pass_ = 0, pass_count_ = 1;
  std::size_t view_ = 0, view_count_ = 1;
};

}  // namespace pelage
