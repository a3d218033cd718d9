// What every verb that makes a picture tells in its `--json`.
#pragma once

#include <fmt/format.h>
#include <pelage/render.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/hash.h"

namespace pelage::cli {

inline nlohmann::ordered_json stages_json(const std::vector<StageStat>& stats) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::array();
  for (const StageStat& s : stats)
    stages.push_back({{"stage", s.stage}, {"seconds", s.seconds}, {"bytes", s.bytes}, {"items", s.items}, {"unit", s.unit}});
  return stages;
}

/// The same for pictures of the same bits.
inline std::string pixel_hash(const Image& image) {
  return fmt::format("{:016x}", hash_bytes(image.pixels.data(), image.pixels.size() * sizeof(float)));
}

}  // namespace pelage::cli
