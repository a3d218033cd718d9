#include "filter/anisotropic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/check.h"
#include "core/parallel.h"
#include "filter/anisotropic_rows.h"
#include "filter/hair_box.h"

namespace pelage {
namespace {

constexpr std::size_t kRowsPerTask = 4;

HairBox tangent_box(const Matte& m) {
  return hair_box(m.width, m.height, [&](std::size_t p) { return m.tangent_x[p] != 0 || m.tangent_y[p] != 0; });
}

FilterPlanes make_planes(const Matte& m, const HairBox& box, int reach) {
  FilterPlanes f;
  f.left = box.left, f.top = box.top, f.width = box.width(), f.height = box.height(), f.reach = reach;
  f.stride = static_cast<std::size_t>(f.width + 2 * reach) + FilterPlanes::kPadding;
  const std::size_t rows = static_cast<std::size_t>(f.height + 2 * reach);
  const std::pair<Buffer<float>*, const Buffer<float>*> planes[] = {{&f.r, &m.r},
                                                                    {&f.g, &m.g},
                                                                    {&f.b, &m.b},
                                                                    {&f.alpha, &m.alpha},
                                                                    {&f.tangent_x, &m.tangent_x},
                                                                    {&f.tangent_y, &m.tangent_y}};
  for (const auto& [to, from] : planes) to->resize(rows * f.stride);
  f.weight.resize(rows * f.stride);
  parallel_for(rows, kRowsPerTask, [&](std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
      const int y = static_cast<int>(row) - reach;
      float* weight = &f.weight[row * f.stride];
      for (const auto& [to, from] : planes) std::fill_n(&(*to)[row * f.stride], f.stride, 0.f);
      std::fill_n(weight, f.stride, 0.f);
      if (y < 0 || y >= f.height) continue;
      const std::size_t p =
          static_cast<std::size_t>(y + f.top) * static_cast<std::size_t>(m.width) + static_cast<std::size_t>(f.left);
      for (const auto& [to, from] : planes) std::copy_n(&(*from)[p], f.width, &(*to)[f.at(0, y)]);
      for (int x = 0; x < f.width; ++x) {
        const std::size_t q = f.at(x, y);
        f.weight[q] = f.tangent_x[q] != 0 || f.tangent_y[q] != 0 ? 1.f : 0.f;
      }
    }
  });
  return f;
}

}  // namespace

AnisotropicKernel kernel_for(const Matte& matte, const LinkSettings& settings) {
  const HairBox box = tangent_box(matte);
  AnisotropicKernel k;
  k.radius = std::min(settings.kernel_size * std::sqrt(static_cast<float>(box.width()) * static_cast<float>(box.height())),
                      AnisotropicKernel::kMostRadius);
  k.aspect = settings.aspect;
  k.sigma_distance = settings.sigma_distance, k.sigma_angle = settings.sigma_angle, k.sigma_color = settings.sigma_color;
  return k;
}

Matte filter_anisotropic(const Matte& m, const AnisotropicKernel& kernel) {
  PELAGE_CHECK(kernel.radius >= 0 && kernel.radius <= AnisotropicKernel::kMostRadius);
  const HairBox box = tangent_box(m);
  const FilterPlanes planes = make_planes(m, box, static_cast<int>(kernel.radius));
  Matte out;
  out.resize(m.width, m.height, !m.coverage.empty());
  const auto width = static_cast<std::size_t>(m.width);
  parallel_for(static_cast<std::size_t>(m.height), kRowsPerTask, [&](std::size_t first, std::size_t last) {
    Buffer<float> row[4];
    for (Buffer<float>& plane : row) plane.resize(static_cast<std::size_t>(planes.width) + FilterPlanes::kPadding);
    for (std::size_t y = first; y < last; ++y) {
      const std::size_t p = y * width;
      std::copy_n(&m.tangent_x[p], width, &out.tangent_x[p]), std::copy_n(&m.tangent_y[p], width, &out.tangent_y[p]);
      if (!m.coverage.empty()) std::copy_n(&m.coverage[p], width, &out.coverage[p]);
      Buffer<float>* const to[] = {&out.r, &out.g, &out.b, &out.alpha};
      for (Buffer<float>* plane : to) std::fill_n(&(*plane)[p], width, 0.f);
      const int inside = static_cast<int>(y) - box.top;
      if (inside < 0 || inside >= box.height()) continue;
      filter_row(planes, kernel, inside, {row[0].data(), row[1].data(), row[2].data(), row[3].data()});
      for (int c = 0; c < 4; ++c) std::copy_n(row[c].data(), box.width(), &(*to[c])[p + static_cast<std::size_t>(box.left)]);
    }
  });
  return out;
}

}  // namespace pelage
