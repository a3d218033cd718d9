// From the units and axes of a file to metres and Y up.
#pragma once

#include <pelage/io.h>

#include "io/strand_registry.h"

namespace pelage::io {

/// Applies scale, up axis and default width to `file`, guessing what neither the file nor `options` say, and tells
/// in `report` what it assumed. Tolerates non-finite points.
void place_strands(FileStrands& file, const ImportOptions& options, ImportReport& report);

}  // namespace pelage::io
