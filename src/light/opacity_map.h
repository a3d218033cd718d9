// Deep opacity maps: how many strands lie between a light and a place (Yuksel & Keyser 2008, "Deep Opacity Maps";
// references.bib: Yuksel2008Opacity).
//
// A hair of 70 µm is a fraction of a texel wide, so a depth map of it would be all or nothing. Instead each piece of a
// strand adds what it covers of a texel: (length inside the texel · width) / texel area, the expected number of its
// crossings by a ray through a random place of the texel. Sums of such expectations are right for any texel size.
#pragma once

#include <span>
#include <vector>

#include "frame/frame.h"
#include "light/strand_lines.h"

namespace pelage {

struct OpacitySettings {
  /// One strand of each n neighbors in the groom is drawn and counts n-fold: expectations stay, noise grows with n.
  std::size_t strand_stride = 1;
};

/// Counts the strands of `grooms` as each of `views` sees them. Segments that reach behind the near plane are left out.
///
/// The origin of the layers is coarser than the map (OpacityMap::kOriginBlock): that costs little detail and saves time.
/// Layer ends double from layer to layer and the last one reaches the farthest strand of all.
/// The result is exact in integers: the same for any thread count. Complexity: O(views · (points drawn + texels touched)).
std::vector<OpacityMap> build_opacity_maps(const std::vector<StrandLines>& grooms, std::span<const CameraView> views,
                                           const OpacitySettings& settings = {});

/// The same for one view.
OpacityMap build_opacity_map(const std::vector<StrandLines>& grooms, const CameraView& view,
                             const OpacitySettings& settings = {});

}  // namespace pelage
