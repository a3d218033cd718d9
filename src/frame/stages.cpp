#include "frame/stages.h"

#include <pelage/error.h>

#include <algorithm>

namespace pelage {

bool Stages::report(const char* name, double share) const {
  const double of_pass = (band_ + std::clamp(share, 0.0, 1.0)) / band_count_;
  const double of_view = (pass_ + of_pass) / pass_count_;
  return !progress_ || progress_(name, (static_cast<double>(view_) + of_view) / static_cast<double>(view_count_));
}

void Stages::tell(const char* name, double share) const {
  if (!report(name, share)) throw Error(name, "", "cancelled", "");
}

void Stages::add(const char* name, const char* unit, const StageWork& work, double seconds) {
  const auto found = std::find_if(stats_.begin(), stats_.end(), [&](const StageStat& s) { return s.stage == name; });
  StageStat& stat = found != stats_.end() ? *found : stats_.emplace_back(StageStat{name, 0, 0, 0, unit});
  stat.seconds += seconds;
  stat.items += work.items;
  stat.bytes = std::max(stat.bytes, work.bytes);
}

}  // namespace pelage
