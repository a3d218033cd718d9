// The levels of detail of a groom in numbers, for machines and for people.
#pragma once

#include <pelage/lod.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pelage::cli {

/// Guides, memory, and an object for every level; lengths in metres.
nlohmann::ordered_json lod_json(const LodHierarchy& lod, const StrandSet& strands);

/// A row for the guides, then a table of the levels and the strands behind them.
std::vector<std::string> lod_rows(const nlohmann::ordered_json& json);

}  // namespace pelage::cli
