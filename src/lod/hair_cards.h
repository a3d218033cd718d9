// A baseline for thick hairs: hair cards, flat strips with a texture of strands that is cut out by alpha, made from the clusters.
// docs/lod.md says what differs from cards of games.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lod/choose_levels.h"
#include "lod/pieces.h"

namespace pelage {

/// One card for every thick hair of the coarsest levels: a strip along its center, as wide as the major axis of its section, which it lies
/// in. Strands are projected onto it; texels are opaque or not.
class HairCards {
 public:
  static constexpr std::size_t kLevels = 3;          ///< of cards; what finer levels would show are strands
  static constexpr std::size_t kColumns = 8;         ///< texels across
  static constexpr std::size_t kRowsPerSegment = 2;  ///< texels along each of the kLodSegments
  static constexpr std::size_t kRows = kLodSegments * kRowsPerSegment;

  /// Paints the textures of `strands` at rest, whose chain `lod` is. Of the texels of a card those are opaque that strands cover most, as
  /// many as keep its mean coverage (after Castaño 2010; references.bib: Castano2010AlphaTested) over all directions around it, of which a
  /// flat strip shows 2/π of its width. Strands beside the card stand at its edge. O(strands), in parallel; the same for any number of threads.
  HairCards(const StrandSet& strands, const LodHierarchy& lod);

  /// The levels of cards: of each the coarsest whose texels are no wider than `pixels` on the screen, else as choose_levels(); or `level` everywhere,
  /// where it is not negative.
  static LodCut choose(const LodPlace& place, const PrismHairs& prisms, float pixels, int level, const LodCut& before);

  /// Draws runs of opaque texels as flat strips, lines that are as wide as `place` sees the texel. Refers to its arguments.
  DrawCluster pen(const StrandSet& strands, const LodPlace& place) const;

  /// Texels of a row of the card of a hair; bit c: column c, from −major to +major, is opaque.
  std::uint8_t row(std::size_t hair, std::size_t row) const { return rows_[hair * kRows + row]; }
  /// Area of the strands over that of the card from its front: the mean coverage before the cut, where they are no longer than the card.
  float coverage(std::size_t hair) const { return coverage_[hair]; }

 private:
  void paint(const StrandSet& strands, const LodHierarchy& lod, std::size_t hair);

  std::vector<std::uint8_t> rows_;  // [hairs · kRows]
  std::vector<float> coverage_;     // [hairs]
};

}  // namespace pelage
