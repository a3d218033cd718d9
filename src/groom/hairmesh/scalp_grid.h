// The scalp of the mannequin as quads: where the columns of a hair mesh have their roots, and which bundles share them.
#pragma once

#include <pelage/vec.h>

#include <array>
#include <cstdint>
#include <vector>

namespace pelage::groom {

struct ScalpGridSettings {
  int rows = 8;          ///< quads from the forehead over the crown to the nape
  int across = 4;        ///< quads from the middle to the hairline, on either side
  float parting_x = 0;   ///< metres left of the middle: where the middle line begins at the forehead
  bool parted = false;   ///< columns of the middle are doubled from the forehead to the crown
  bool divided = false;  ///< columns from crown to ears are doubled: hair in front of the shoulders parts from that behind them
  bool separate = false;  ///< no bundle shares columns with another
};

/// Root of a column.
struct ScalpColumn {
  Vec3 root, normal;    ///< on the skin, or 1.5 mm above it within the scalp
  float along = 0;      ///< 0 forehead … 1 nape
  float down = 0;       ///< 0 middle … 1 hairline
  int side = 0;         ///< of a parting: −1 right, 1 left (positive x), 0 neither
  bool behind = false;  ///< goes behind the shoulder, if it comes to one
};

struct ScalpGrid {
  std::vector<ScalpColumn> columns;
  std::vector<std::array<std::uint32_t, 4>>
      quads;  ///< columns at (u, v) = (0, 0), (1, 0), (1, 1), (0, 1): u runs along, v down
};

/// Each half of the scalp is a patch between four curves: the middle, and the hairline over forehead, ear and nape.
ScalpGrid make_scalp_grid(const ScalpGridSettings& settings);

/// Where the ray from `from`, inside the head, leaves it; `direction` has unit length.
Vec3 skin_along(Vec3 from, Vec3 direction);

/// Middle of the skull.
inline constexpr Vec3 kSkullCenter{0, 0.03f, -0.012f};

}  // namespace pelage::groom
