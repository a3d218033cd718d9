// Lod: how many strands of each bundle of hair are drawn, and how finely (Lipp 2026, §3.2; references.bib: Lipp2026Deferred).
#pragma once

#include <pelage/scene.h>

#include <span>

#include "frame/deferred.h"

namespace pelage {

/// Chooses for every bundle by its size on the screen, with `settings` of method swr: eq. 1–5 where its level of detail is on,
/// all strands and points otherwise. Several views show the same strands: as many as the one that asks for the most. Bundles that
/// no view can see anything of are left out. The others come nearest first.
///
/// views: 1…kMostViews. O(bundles · layers · views), in parallel; the same for any number of threads.
LodSelection select_lod(const Scene& scene, std::span<const DeferredGroom> grooms, std::span<const CameraView> views);

}  // namespace pelage
