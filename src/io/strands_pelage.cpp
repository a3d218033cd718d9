// Our own binary format: lossless, versioned, every section checksummed. Byte for byte in docs/formats.md.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "io/animation_sections.h"
#include "io/lod_sections.h"
#include "io/pelage_container.h"
#include "io/strand_formats.h"

namespace pelage::io {
namespace {

// Calls visit(name, components, array) for every array of a StrandSet that is stored as it stands.
template <class Set, class Visit>
void for_each_array(Set& set, const Visit& visit) {
  visit("points", 3u, set.points);
  visit("widths", 1u, set.widths);
  visit("colors", 3u, set.colors);
  visit("transp", 1u, set.transparency);
  visit("rootuv", 2u, set.root_uv);
  visit("strandid", 1u, set.strand_id);
  visit("guideid", 1u, set.guide_id);
  visit("group", 1u, set.group);
}

std::string mismatch(const ByteSource& source) { return pelage_magic(source) ? "" : "does not begin with \\x89PELAGE"; }

void check_header(const PelageReader& file) {
  const PelageHeader& header = file.header();
  if (header.basis > static_cast<std::uint32_t>(CurveBasis::kBezier))
    file.bad("header", fmt::format("curve basis {}", header.basis));
  // Points bound everything that is allocated from the header's counts, and they have to be in the file.
  if (header.points > UINT32_MAX || header.points > file.source().size() / sizeof(Vec3) || header.strands > header.points)
    file.bad("header", fmt::format("{} strands of {} points announced", header.strands, header.points));
}

void read_offsets(PelageReader& file, std::vector<std::uint32_t>& offsets) {
  const PelageHeader& header = file.header();
  std::vector<std::uint32_t> counts;
  file.read("counts", 1, counts, {header.strands});
  if (counts.empty() && header.strands * header.points_per_strand != header.points)
    file.bad("header", fmt::format("{} strands of {} points each do not make {}", header.strands, header.points_per_strand,
                                   header.points));
  offsets.resize(header.strands + 1);
  std::uint64_t sum = 0;
  for (std::size_t s = 0; s < header.strands; ++s) {
    sum += counts.empty() ? header.points_per_strand : counts[s];
    if (sum > header.points)
      file.bad(fmt::format("strand {}", s),
               fmt::format("the strands up to it have {} points, the file {}", sum, header.points));
    offsets[s + 1] = static_cast<std::uint32_t>(sum);
  }
  if (sum != header.points) file.bad("section counts", fmt::format("they make {} points of {}", sum, header.points));
}

FileStrands read(const ByteSource& source, const Progress& progress) {
  PelageReader file(source, progress);
  check_header(file);
  const std::uint64_t strands = file.header().strands, points = file.header().points;
  FileStrands out;
  StrandSet& set = out.strands;
  set.basis = static_cast<CurveBasis>(file.header().basis);
  read_offsets(file, set.offsets);
  for_each_array(set, [&](std::string_view name, std::uint32_t components, auto& array) {
    if (name == "points" || name == "transp") file.read(name, components, array, {points});
    else if (name == "widths") file.read(name, components, array, {points, 1});
    else if (name == "colors") file.read(name, components, array, {strands, points});
    else file.read(name, components, array, {strands});
  });
  if (set.points.size() != points) file.bad("section points", "missing");
  if (const PelageSection* comment = file.take("comment")) {
    set.comment.resize(comment->bytes);
    file.read_checked(*comment, set.comment.data());
  }
  for (const std::string& section : file.left())
    if (!is_lod_section(section) && !is_animation_section(section))
      out.notes.push_back(fmt::format("section '{}' of a newer Pelage was ignored", section));
  out.scale = 1;
  out.up_stated = true;
  return out;
}

std::vector<std::string> write(AtomicFile& file, const StrandSet& set, const Progress& progress) {
  write_pelage(file, set, nullptr, progress);
  return {};
}

}  // namespace

void write_pelage(AtomicFile& file, const StrandSet& set, const LodHierarchy* lod, const Progress& progress) {
  PelageWriter writer;
  PelageHeader& header = writer.header();
  header.strands = set.strand_count(), header.points = set.point_count();
  header.basis = static_cast<std::uint32_t>(set.basis);
  std::vector<std::uint32_t> counts(set.strand_count());
  for (std::size_t s = 0; s < counts.size(); ++s) counts[s] = set.offsets[s + 1] - set.offsets[s];
  const bool uniform = std::all_of(counts.begin(), counts.end(), [&](std::uint32_t c) { return c == counts[0]; });
  if (uniform) header.points_per_strand = counts.empty() ? 0 : counts[0];
  else writer.add("counts", 1, counts);
  for_each_array(
      set, [&](std::string_view name, std::uint32_t components, const auto& array) { writer.add(name, components, array); });
  writer.add("comment", 1, set.comment.data(), set.comment.size(), 1);
  const LodHead head = lod ? lod_head(*lod, writer.checksum("points")) : LodHead();
  if (lod) add_lod_sections(*lod, head, writer);
  const GuideAnimation* animation = lod ? lod->animation.get() : nullptr;
  const AnimationHead moved = animation ? animation_head(*animation, writer.checksum("lodguidp")) : AnimationHead();
  if (animation) add_animation_sections(*animation, moved, writer);
  writer.write(file, progress);
}

const StrandFormat kPelage = {
    {"pelage", "Pelage binary: everything, checksummed; meters, Y up", {"pelage"}, true, true}, mismatch, read, write};

}  // namespace pelage::io
