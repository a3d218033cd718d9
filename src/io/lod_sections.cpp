#include "io/lod_sections.h"

#include <pelage/error.h>
#include <pelage/io.h>

#include "io/animation_sections.h"
#include "io/told.h"
#include "io/xxh64.h"

namespace pelage {
namespace io {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::string_view kPrefix = "lod";

// Calls visit(name, components, array, entries, optional) for every array.
template <class Lod, class Visit>
void for_each_array(Lod& lod, const LodHead& head, std::uint64_t strands, const Visit& visit) {
  const std::uint64_t hairs = head.hairs, points = hairs * LodHierarchy::kPoints;
  visit("lodguide", 1u, lod.guide_strands, head.guides, false);
  visit("lodguidp", 3u, lod.guides, std::uint64_t{head.guides} * LodHierarchy::kPoints, false);
  visit("lodprism", 3u, lod.prisms, head.prisms, false);
  visit("lodorder", 1u, lod.order, strands, false);
  visit("lodstrnw", 2u, lod.strand_weights, strands, false);
  visit("lodlevel", 1u, lod.level_offsets, std::uint64_t{head.levels} + 1, false);
  visit("lodhairs", 6u, lod.hairs, hairs, false);
  visit("lodhairw", 2u, lod.weights, hairs, false);
  visit("lodcentr", 3u, lod.centers, points, false);
  visit("lodmajor", 3u, lod.major, points, false);
  visit("lodminor", 3u, lod.minor, points, false);
  visit("lodmajw", 2u, lod.major_weights, points, false);
  visit("lodminw", 2u, lod.minor_weights, points, false);
  visit("lodradii", 1u, lod.radii, points, false);
  visit("lodratio", 1u, lod.length_ratios, hairs, false);
  visit("lodtwist", 1u, lod.twists, hairs, true);
  visit("lodcolor", 3u, lod.colors, hairs, true);
  visit("loduv", 2u, lod.root_uv, hairs, true);
}
static_assert(sizeof(ThickHair) == 6 * sizeof(std::uint32_t));

std::uint64_t checksum_of_points(PelageReader& file) {
  const PelageSection* points = file.take("points");
  if (!points) file.bad("section points", "missing");
  return points->checksum;
}

}  // namespace

bool is_lod_section(std::string_view name) { return name.starts_with(kPrefix); }

LodHead lod_head(const LodHierarchy& lod, std::uint64_t strands_checksum) {
  return {kVersion,
          LodHierarchy::kPoints,
          static_cast<std::uint32_t>(lod.levels()),
          static_cast<std::uint32_t>(lod.hair_count()),
          static_cast<std::uint32_t>(lod.prisms.size()),
          static_cast<std::uint32_t>(lod.guide_count()),
          strands_checksum};
}

void add_lod_sections(const LodHierarchy& lod, const LodHead& head, PelageWriter& writer) {
  writer.add("lodhead", 1, &head, 1, sizeof head);
  for_each_array(lod, head, lod.strand_count(),
                 [&](std::string_view name, std::uint32_t components, const auto& array, std::uint64_t, bool) {
                   writer.add(name, components, array);
                 });
}

LodHierarchy read_lod(const ByteSource& source, const Progress& progress) {
  LodHierarchy lod;
  if (!pelage_magic(source)) return lod;
  PelageReader file(source, progress);
  std::vector<LodHead> heads;
  file.read("lodhead", 1, heads, {1});
  if (heads.empty()) return lod;
  const LodHead& head = heads.front();
  if (head.version != kVersion || head.points != LodHierarchy::kPoints)
    throw Error(source.name(), "section lodhead",
                fmt::format("levels of detail of version {} with {} points a hair; this program reads version {} with {}",
                            head.version, head.points, kVersion, LodHierarchy::kPoints),
                "build them again: pelage lod build");
  if (head.strands_checksum != checksum_of_points(file))
    throw Error(source.name(), "section lodhead", "the levels of detail were built for other strands",
                "build them again: pelage lod build");
  for_each_array(lod, head, file.header().strands,
                 [&](std::string_view name, std::uint32_t components, auto& array, std::uint64_t entries, bool optional) {
                   file.read(name, components, array, {entries});
                   if (!optional && array.size() != entries) file.bad(fmt::format("section {}", name), "missing");
                 });
  lod.animation = read_animation(file, lod.guide_count(), xxh64(lod.guides.data(), lod.guides.size() * sizeof(Vec3)));
  validate(lod, source.name());
  return lod;
}

}  // namespace io

LodHierarchy read_lod(const std::string& path, const Progress& progress) {
  return io::read_lod(io::ByteSource::open(path), progress);
}

std::shared_ptr<const LodHierarchy> read_chain(const std::string& path, const StrandSet& strands, const Progress& progress) {
  auto lod = std::make_shared<LodHierarchy>(read_lod(path, progress));
  if (lod->empty()) return nullptr;
  try {
    validate(*lod, strands, path);
  } catch (const Error&) {
    return nullptr;
  }
  return lod;
}

void write_lod(const std::string& path, const StrandSet& strands, const LodHierarchy& lod, const Progress& progress) {
  if (!path.ends_with(".pelage"))
    throw Error(path, "", "levels of detail are stored in .pelage files only", "call it name.pelage");
  validate(strands, path);
  validate(lod, strands, path);
  io::AtomicFile file(path);
  io::write_pelage(file, strands, &lod, progress);
  io::tell(progress, "io.write", 1, path);
  file.commit();
}

}  // namespace pelage
