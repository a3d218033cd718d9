#include "groom/hierarchy.h"

#include <algorithm>

#include "core/parallel.h"
#include "groom/point_grid.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

/// Where each guide is bound for, as a unit vector.
std::vector<Vec3> headings(const GuideSet& guides) {
  std::vector<Vec3> heading(guides.count());
  const std::size_t n = static_cast<std::size_t>(guides.points);
  for (std::size_t g = 0; g < heading.size(); ++g)
    heading[g] = normalize(guides.position[g * n + n / 4] - guides.position[g * n]);
  return heading;
}

}  // namespace

std::vector<Membership> find_memberships(const GuideSet& guides, const std::vector<Root>& roots, int tuft_size) {
  PointGrid guide_grid(typical_spacing(guides.roots, guides.count()), guides.count());
  for (const Root& root : guides.roots) guide_grid.insert(root.position);
  const std::size_t tufts = (roots.size() + static_cast<std::size_t>(tuft_size) - 1) / static_cast<std::size_t>(tuft_size);
  PointGrid tuft_grid(typical_spacing(roots, tufts), tufts);
  for (std::size_t i = 0; i < tufts; ++i) tuft_grid.insert(roots[i].position);
  const std::vector<Vec3> heading = headings(guides);

  std::vector<Membership> members(roots.size());
  parallel_for(roots.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Membership& m = members[i];
      float d2[kBlend], sum = 0;
      const int count = guide_grid.nearest(roots[i].position, kBlend, m.guide, d2);
      for (int k = 0; k < kBlend; ++k) {
        if (k >= count) m.guide[k] = m.guide[0];
        const float agree = k == 0 ? 1 : smoothstep(0.5f, 0.9f, dot(heading[m.guide[0]], heading[m.guide[k]]));
        m.weight[k] = k < count ? agree / (d2[k] + 1e-8f) : 0;
        sum += m.weight[k];
      }
      for (float& weight : m.weight) weight /= sum;
      float tuft_d2;
      tuft_grid.nearest(roots[i].position, 1, &m.tuft, &tuft_d2);
    }
  });
  // A tuft lies within one lock. Read and write apart: the middle of a tuft always keeps itself.
  for (std::size_t i = 0; i < members.size(); ++i)
    if (members[members[i].tuft].guide[0] != members[i].guide[0]) members[i].tuft = static_cast<std::uint32_t>(i);
  return members;
}

std::vector<std::uint32_t> order_by_guide(const std::vector<Membership>& members, std::size_t guide_count) {
  std::vector<std::uint32_t> start(guide_count + 1, 0), order(members.size());
  for (const Membership& m : members) ++start[m.guide[0] + 1];
  for (std::size_t g = 0; g < guide_count; ++g) start[g + 1] += start[g];
  for (std::uint32_t i = 0; i < members.size(); ++i) order[start[members[i].guide[0]]++] = i;
  return order;
}

}  // namespace pelage::groom
