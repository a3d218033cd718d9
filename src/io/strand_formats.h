// What the format files share with the registry.
#pragma once

#include <pelage/strand_set.h>

#include <string>
#include <string_view>
#include <vector>

#include "io/strand_registry.h"

namespace pelage::io {

extern const StrandFormat kPelage, kCyHair, kTressFx, kTressFx3, kUsc;

/// Attributes beyond points that a format can hold; for report_lost().
enum StrandAttribute : unsigned { kWidths = 1, kStrandWidths = 2, kPointColors = 4, kTransparencies = 8, kRootUv = 16 };

/// Adds a sentence to `lost` for every attribute of `set` that a format with the attributes `kept` cannot hold.
void report_lost(const StrandSet& set, unsigned kept, std::string_view format, std::vector<std::string>& lost);

}  // namespace pelage::io
