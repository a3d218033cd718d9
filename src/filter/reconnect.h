// The reconnection filter of deferred software rasterization: one pass from two layers of one sample to smooth strands with
// opacity (Lipp 2026, §3.3; references.bib: Lipp2026Deferred).
#pragma once

#include <pelage/scene.h>

#include "core/buffer.h"
#include "frame/deferred.h"

namespace pelage {

/// Filters `buffer`, which has both layers; `radiance` is that of its center layer.
///
/// In dense hair a pixel takes mean color and share of the center hits under a kernel that lies along the strand in front (eq. 9);
/// colors count of neighbors whose conservative hits are as deep as that strand would be there, by `depth_tolerance`. Lone strands,
/// and with SwrAlpha::kRatio all pixels, are reconnected as published: a pixel whose center is hit takes the mean of its neighbors
/// along its own strand (eq. 10); one that is only touched borrows color from neighbors whose centers are hit; where what touches
/// it lies in front of what its center shows by `connect_depth`, the one is laid over the other, which is opaque then. Opacity is
/// the share of center hits among all hits in a strip along the strand.
/// `coverage`, where not empty, [h·w] 0…1, takes the place of either share.
/// Deterministic. O(pixels with hair · taps), in parallel.
HairPicture reconnect(const DeferredBuffer& buffer, const Radiance& radiance, const SwrSettings& settings,
                      const Buffer<float>& coverage = {});

/// Neighbors whose spatial weight is below this, 1 in the middle, are left out.
inline constexpr float kLeastReconnectWeight = 0.002f;

/// The plain mean of the samples of each pixel, without a filter: of sample_keys, or of `center`.
HairPicture mean_of_samples(const DeferredBuffer& buffer, const Radiance& radiance);

}  // namespace pelage
