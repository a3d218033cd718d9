// Progress of long work, told to whoever waits for it.
#pragma once

#include <functional>
#include <string_view>

namespace pelage {

/// Called from one thread at a time with the stage's name and the share done, 0…1, non-decreasing within a stage.
/// Return false to cancel: the work stops soon after and throws Error("…", "", "cancelled", "").
/// An empty function means that nobody waits.
using Progress = std::function<bool(std::string_view stage, double share)>;

}  // namespace pelage
