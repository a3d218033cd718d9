#include <pelage/grow.h>

#include <algorithm>

#include "groom/check_range.h"
#include "groom/mannequin.h"
#include "groom/strands.h"

namespace pelage {
namespace {

void check(const GrowSettings& s) {
  using groom::check_range;
  check_range("strands", s.strands, 1, 1000000);
  check_range("points", s.points, 4, 1024);
  check_range("strands × points", static_cast<double>(s.strands) * s.points, 4, 4294967295.0);
  check_range("length", s.length, 1e-4f, 10);
  check_range("length_variation", s.length_variation, 0, 0.5f);
  check_range("width", s.width, 0, 0.1f);
  check_range("width_variation", s.width_variation, 0, 0.5f);
  check_range("taper", s.taper, 0, 1);
  check_range("curl_radius", s.curl_radius, 0, 1);
  check_range("curl_pitch", s.curl_pitch, 1e-4f, 10);
  check_range("clumps", s.clumps, 0, 1000000);
  check_range("clump_tightness", s.clump_tightness, 0, 1);
  check_range("frizz", s.frizz, 0, 1);
  check_range("flyaways", s.flyaways, 0, 1);
  check_range("gravity", s.gravity, 0, 1);
  check_range("volume", s.volume, 0, 0.5f);
  check_range("parting", s.parting, -0.05f, 0.05f);
  check_range("undercoat", s.undercoat, 0, 1);
}

}  // namespace

StrandSet grow(const GrowSettings& settings, const TriangleMesh& surface, const Progress& progress) {
  using namespace groom;
  check(settings);
  Ground ground;
  ground.mesh = &surface;
  ground.scalp = is_mannequin(surface);
  ground.size = std::max(length(bounds(surface).extent()), 1e-6f);
  if (ground.scalp) ground.collider = &mannequin().grid;

  constexpr int kUnclumpedGuides = 500;
  const int wanted = settings.clumps > 0 ? settings.clumps : kUnclumpedGuides;
  const std::size_t guide_count = static_cast<std::size_t>(std::min(wanted, settings.strands));
  const float longest = settings.length * (1 + 2.5f * settings.length_variation);
  const GuideSet guides = grow_guides(settings, ground, guide_count, longest);
  const std::vector<Root> roots =
      scatter_roots(surface, static_cast<std::size_t>(settings.strands), settings.seed, ground.density());
  return fill_strands(settings, ground, guides, roots, progress);
}

}  // namespace pelage
