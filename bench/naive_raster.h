// The plain way to rasterize strands, without blocks or lanes: project the points of a strand, walk each segment's band
// column by column, compare, then an atomic minimum. What the fast way must agree with, bit by bit, and is measured by.
#pragma once

#include <vector>

#include "assemble/assemble.h"
#include "core/parallel.h"
#include "frame/curve_basis.h"
#include "raster/band_walk.h"
#include "raster/keys.h"
#include "frame/sample_positions.h"

namespace pelage::bench {

struct NaivePoint {
  float x, y, depth, radius;
  Vec2 cap;
};

inline NaivePoint naive_project(const CameraView& view, Vec3 c, float half_width) {
  const float scale = view.perspective ? view.focal / c.z : view.focal;
  return {view.center_x + scale * c.x, view.center_y + scale * c.y, c.z, half_width * scale, {}};
}

/// The projected polyline of one strand. Strands must lie between the near plane and the guard band: nothing is clipped.
inline void naive_points(const AssembleJob& job, std::size_t strand, std::vector<NaivePoint>& out) {
  const StrandSet& set = *job.strands;
  const std::uint32_t begin = set.offsets[strand], end = set.offsets[strand + 1], parts = job.subdivisions;
  const float half = 0.5f * job.width_scale;
  const auto camera = [&](std::uint32_t i) { return transform_point(job.to_camera, set.points[i]); };
  out.clear();
  if (parts == 1 && (set.basis == CurveBasis::kLinear || set.basis == CurveBasis::kCatmullRom)) {
    for (std::uint32_t i = begin; i < end; ++i) out.push_back(naive_project(job.view, camera(i), set.width(i) * half));
    return;
  }
  const std::uint32_t spans = span_count(set.basis, end - begin), stride = set.basis == CurveBasis::kBezier ? 3 : 1;
  for (std::uint32_t s = 0; s < spans; ++s) {
    const std::uint32_t i = begin + s * stride;
    Vec3 p[4];
    if (stride == 3) {
      for (std::uint32_t j = 0; j < 4; ++j) p[j] = camera(i + j);
    } else {
      p[1] = camera(i), p[2] = camera(i + 1);
      p[0] = i > begin ? camera(i - 1) : p[1] * 2.f - p[2];
      p[3] = i + 2 < end ? camera(i + 2) : p[2] * 2.f - p[1];
    }
    const float wa = set.width(i) * half, wb = set.width(i + stride) * half;
    for (std::uint32_t k = 0; k < (s + 1 == spans ? parts + 1 : parts); ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(parts);
      const Vec3 c = kernel::curve_combine(basis_weights(set.basis, t), p[0], p[1], p[2], p[3]);
      out.push_back(naive_project(job.view, c, wa + (wb - wa) * t));
    }
  }
}

inline void naive_caps(std::vector<NaivePoint>& points) {
  Vec2 previous;
  float previous_length = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool last = i + 1 == points.size();
    const Vec2 next = last ? Vec2() : Vec2(points[i + 1].x - points[i].x, points[i + 1].y - points[i].y);
    const float next_length = length(next);
    Vec2 cap = kernel::raster_cap(previous, previous_length, next, next_length);
    if (!(dot(cap, cap) > 0)) {
      cap = next_length > 0 ? next : previous;
      if (previous_length > 0 && next_length > 0) cap = Vec2(-previous.y, previous.x);
    }
    points[i].cap = cap;
    if (next_length > 0) previous = next, previous_length = next_length;
  }
}

/// Calls visit(band, id) for every segment of `job`, in parallel.
template <class Visit>
void naive_bands(const AssembleJob& job, const Visit& visit) {
  parallel_for(job.strands->strand_count(), 64, [&](std::size_t begin, std::size_t end) {
    std::vector<NaivePoint> points;
    for (std::size_t s = begin; s < end; ++s) {
      naive_points(job, s, points);
      naive_caps(points);
      const std::uint32_t id = job.base_id + job.strands->offsets[s] * job.subdivisions;
      for (std::uint32_t j = 0; j + 1 < points.size(); ++j) {
        const NaivePoint &a = points[j], &b = points[j + 1];
        visit(kernel::raster_band({a.x, a.y}, {b.x, b.y}, a.radius, b.radius, a.depth, b.depth, a.cap, b.cap), id + j);
      }
    }
  });
}

inline std::size_t naive_pixel(const CameraView& view, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x);
}

/// The center layer of one groom, into cleared `keys`.
inline void naive_center(const AssembleJob& job, Buffer<PixelKey>& keys) {
  const CameraView& view = job.view;
  naive_bands(job, [&](const kernel::RasterBand& band, std::uint32_t id) {
    walk_centers(band, view.width, view.height,
                 [&](int x, int y, float depth) { atomic_min(keys[naive_pixel(view, x, y)], pixel_key(depth, id)); });
  });
}

/// A sample layer, into cleared `keys`.
inline void naive_samples(const AssembleJob& job, int samples, Buffer<PixelKey>& keys) {
  const CameraView& view = job.view;
  const auto positions = sample_positions(samples);
  naive_bands(job, [&](const kernel::RasterBand& band, std::uint32_t id) {
    const auto emit = [&](int x, int y, float depth, std::uint32_t mask) {
      PixelKey* const pixel = &keys[naive_pixel(view, x, y) * static_cast<std::size_t>(samples)];
      for (int s = 0; s < samples; ++s)
        if (mask >> s & 1) atomic_min(pixel[s], pixel_key(depth, id));
    };
    walk_samples(band, view.width, view.height, positions.data(), samples, emit);
  });
}

}  // namespace pelage::bench
