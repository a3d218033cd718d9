// The environment prefiltered by GGX lobes of growing roughness, for strands that ask for it by one lobe or two.
#pragma once

#include <pelage/scene.h>

#include "frame/frame.h"

namespace pelage {

/// Blurs the environment, map and constant, by every roughness of kernel/light/probe.h. Every texel is a weighted mean of
/// radiance: of an even environment exactly its radiance.
///
/// Deterministic for any number of threads. Complexity: O(levels · side² · 8192), about a quarter of a second; nothing
/// without a map.
EnvironmentProbe make_probe(const Environment& environment);

/// Radiance about `d` (unit length, world space), blurred by a lobe of roughness `alpha`, W/(m²·sr): linear between texels
/// and between levels, within kProbeMaxRelError. alpha below the first level acts as that. `probe` must not be empty.
Vec3 probe_radiance(const EnvironmentProbe& probe, Vec3 d, float alpha);

}  // namespace pelage
