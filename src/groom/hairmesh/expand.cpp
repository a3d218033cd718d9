#include <pelage/error.h>
#include <pelage/hair_mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/shared_progress.h"
#include "groom/hairmesh/strand_group.h"

namespace pelage {
namespace {

/// Where the strands of a bundle go.
struct Part {
  const HairMesh::Bundle* bundle;
  std::uint32_t strands, points;   // of them, and of each
  std::size_t first, first_point;  // in the set
  std::size_t full_first;          // at full detail: for strand_id
};

std::vector<Part> parts_of(const HairMesh& mesh, const ExpandSettings& settings) {
  std::vector<Part> parts;
  std::size_t strands = 0, points = 0, full = 0;
  for (const HairMesh::Bundle& b : mesh.bundles) {
    const auto some = static_cast<std::uint32_t>(std::ceil(static_cast<double>(settings.share) * b.strands));
    Part part{&b, std::min(some, b.strands), std::max(settings.points, mesh.layers(b)), strands, points, full};
    strands += part.strands, points += std::size_t{part.strands} * part.points, full += b.strands;
    parts.push_back(part);
  }
  if (points >= 0xffffffffu)
    throw Error("hair mesh", "", fmt::format("its strands have {} points", points),
                "fewer than 2³²: a smaller share or fewer points");
  return parts;
}

void put_group(const Part& part, const StrandGroup& g, std::uint32_t begin, StrandSet& set) {
  for (std::size_t l = 0; l < g.strands; ++l) {
    const std::size_t strand = part.first + begin + l, first = part.first_point + (begin + l) * part.points;
    set.offsets[strand + 1] = static_cast<std::uint32_t>(first + part.points);
    set.root_uv[strand] = {g.u[l], g.v[l]};
    set.strand_id[strand] = static_cast<std::uint32_t>(part.full_first + begin + l);
    set.group[strand] = static_cast<std::uint16_t>(part.bundle->style);
    for (std::size_t i = 0; i < part.points; ++i) {
      const std::size_t from = i * StrandGroup::kLanes + l;
      set.points[first + i] = {g.x[from], g.y[from], g.z[from]};
      set.widths[first + i] = g.width[from];
    }
  }
}

}  // namespace

StrandSet expand(const HairMesh& mesh, const ExpandSettings& settings, const Progress& progress) {
  if (settings.points < 2 || settings.points > kHairMeshPoints)
    throw Error("hair mesh", "points", fmt::format("{} is out of range", settings.points),
                fmt::format("2…{}", kHairMeshPoints));
  if (!(settings.share >= 0 && settings.share <= 1))
    throw Error("hair mesh", "share", fmt::format("{} is out of range", settings.share), "0…1");
  validate(mesh, "hair mesh");
  const std::vector<Part> parts = parts_of(mesh, settings);
  const std::size_t strands = parts.back().first + parts.back().strands;
  const std::size_t points = parts.back().first_point + std::size_t{parts.back().strands} * parts.back().points;
  StrandSet set;
  set.basis = CurveBasis::kLinear;
  set.comment = mesh.comment;
  set.points.resize(points), set.widths.resize(points), set.offsets.resize(strands + 1);
  set.root_uv.resize(strands), set.strand_id.resize(strands), set.group.resize(strands);
  SharedProgress shared(progress, "expand", std::max<std::size_t>(1, strands));
  parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    thread_local StrandGroup group;
    for (std::size_t p = begin; p < end; ++p) {
      const Part& part = parts[p];
      const BundleCage cage(mesh, *part.bundle);
      for (std::uint32_t s = 0; s < part.strands; s += StrandGroup::kLanes) {
        make_strands(cage, s, std::min<std::size_t>(StrandGroup::kLanes, part.strands - s), part.points, group);
        put_group(part, group, s, set);
      }
      shared.add(part.strands);
    }
  });
  return set;
}

}  // namespace pelage
