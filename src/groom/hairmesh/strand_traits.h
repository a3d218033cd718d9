// What is random about a strand of a hair mesh, and does not change along it.
#pragma once

#include <cstdint>

#include "groom/hairmesh/cage.h"
#include "groom/hairmesh/strand_group.h"

namespace pelage {

/// One value a strand, for the operators of its style. Without an operator its values are those that change nothing.
struct StrandTraits {
  using Lanes = StrandGroup::Lanes;
  alignas(64) Lanes u, v;                              ///< place in the bundle, 0…1
  alignas(64) Lanes groom_u, groom_v;                  ///< place in the groom, 0…1
  alignas(64) Lanes length;                            ///< w of the tip
  alignas(64) Lanes clump_u, clump_v, clump;           ///< middle of its clump in the bundle, and how far it is drawn there
  alignas(64) Lanes braid;                             ///< thickness of its lock
  alignas(64) Lanes wave_phase, wave_x, wave_y;        ///< turns, and the direction in which it swings times the amplitude
  alignas(64) Lanes curl_phase;                        ///< turns
  alignas(64) Lanes noise_phase;                       ///< turns
  alignas(64) Lanes frizz, frizz_a, frizz_b, frizz_c;  ///< metres, and turns
  alignas(64) Lanes tip_width;                         ///< as a share of the root's
};

/// Place in the bundle of its strand number `strand`: the R2 sequence (Roberts2018Quasirandom), from a random start. Every prefix of it is
/// spread evenly.
Vec2 strand_place(const HairMesh::Bundle& bundle, std::uint32_t strand);

/// Traits of strands first … first + count − 1; further lanes repeat the first one.
void make_traits(const BundleCage& cage, std::uint32_t first, std::size_t count, StrandTraits& traits);

}  // namespace pelage
