#include "groom/hierarchy.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "groom/point_grid.h"
#include "groom/sdf.h"

namespace pelage::groom {
namespace {

constexpr int kCandidates = 6;  // guides looked at for each strand

/// The kBlend best of the guides near `root`: distance counts, and more where the combing disagrees.
void choose_guides(const PointGrid& grid, const std::vector<Vec3>& guide_combing, Vec3 root, Vec3 root_combing, Membership& m) {
  std::uint32_t guide[kCandidates];
  float cost[kCandidates], sum = 0;
  const int count = grid.nearest(root, kCandidates, guide, cost);
  for (int k = 0; k < count; ++k)
    cost[k] = (cost[k] + 1e-8f) * (1 + 60 * smoothstep(0.7f, 0.2f, dot(root_combing, guide_combing[guide[k]])));
  for (int k = 0; k < kBlend; ++k) {
    const int taken = std::min(k, count - 1);
    int best = taken;
    for (int i = taken + 1; i < count; ++i)
      if (cost[i] < cost[best]) best = i;
    std::swap(cost[taken], cost[best]), std::swap(guide[taken], guide[best]);
    m.guide[k] = guide[taken];
    m.weight[k] = k < count ? 1 / cost[taken] : 0;
    sum += m.weight[k];
  }
  for (float& weight : m.weight) weight /= sum;
}

}  // namespace

std::vector<Membership> find_memberships(const GrowSettings& settings, const Ground& ground, const GuideSet& guides,
                                         const std::vector<Root>& roots, int tuft_size) {
  PointGrid guide_grid(typical_spacing(guides.roots, guides.count()), guides.count());
  std::vector<Vec3> guide_combing;
  guide_combing.reserve(guides.count());
  for (const Root& root : guides.roots) {
    guide_grid.insert(root.position);
    guide_combing.push_back(normalize(combing(settings, ground, root)));
  }
  const std::size_t tufts = (roots.size() + static_cast<std::size_t>(tuft_size) - 1) / static_cast<std::size_t>(tuft_size);
  PointGrid tuft_grid(typical_spacing(roots, tufts), tufts);
  for (std::size_t i = 0; i < tufts; ++i) tuft_grid.insert(roots[i].position);

  std::vector<Membership> members(roots.size());
  parallel_for(roots.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      choose_guides(guide_grid, guide_combing, roots[i].position, normalize(combing(settings, ground, roots[i])), members[i]);
      float distance2;
      tuft_grid.nearest(roots[i].position, 1, &members[i].tuft, &distance2);
    }
  });
  // A tuft lies within one lock; its middle always keeps itself.
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
