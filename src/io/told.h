// Progress told from inside the readers and writers.
#pragma once

#include <pelage/error.h>
#include <pelage/progress.h>

#include <string>

namespace pelage::io {

/// Tells `share` of `stage`; throws Error when the listener cancels.
inline void tell(const Progress& progress, const char* stage, double share, const std::string& where) {
  if (progress && !progress(stage, share)) throw Error(where, "", "cancelled", "");
}

}  // namespace pelage::io
