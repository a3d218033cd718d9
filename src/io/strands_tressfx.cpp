// TressFX binary `.tfx`, version 4 and (reading only) 3, after GPUOpen's TressFXFileFormat.h corrected against real
// files: docs/formats.md.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/strand_formats.h"
#include "io/told.h"

namespace pelage::io {
namespace {

struct Header {
  float version;
  std::uint32_t strands, points_per_strand;
  std::uint32_t positions, strand_uv, vertex_uv, strand_thickness, vertex_color;  // bytes from the file's begin; 0 absent
  std::uint32_t reserved[32];
};
static_assert(sizeof(Header) == 160);

struct Header3 {
  float version;
  std::uint32_t strands, points_per_strand, follow_strands, both_ends_fixed;
  std::uint32_t reserved1[31];
  std::uint32_t positions, strand_thickness, strand_uv, vertex_color, guide_strand, vertex_uv;
  std::uint32_t reserved2[32];
};
static_assert(sizeof(Header3) == 296);

// What both versions come to.
struct Contents {
  std::uint64_t strands, points_per_strand;
  std::uint64_t header_bytes, position_bytes;  // a position is Vec4 in version 4, Vec3 in 3
  std::uint32_t positions, strand_uv, strand_thickness, vertex_color, vertex_uv;
  std::uint64_t points() const { return strands * points_per_strand; }
};

constexpr std::size_t kChunk = 64 * 1024;  // records read at once

template <int kVersion>
std::string mismatch(const ByteSource& source) {
  if (source.size() < sizeof(float)) return "shorter than its version number";
  const auto version = source.get<float>(0, "version");
  return version >= kVersion && version < kVersion + 1 ? "" : fmt::format("does not begin with version {}.0", kVersion);
}

// Calls store(i, record) for each of `count` records that begin at `offset`.
template <class Record, class Store>
void for_each_record(const ByteSource& source, std::uint64_t offset, std::size_t count, const char* what, const Store& store) {
  std::vector<Record> chunk(std::min(count, kChunk));
  for (std::size_t begin = 0; begin < count; begin += chunk.size()) {
    const std::size_t n = std::min(chunk.size(), count - begin);
    source.read(offset + begin * sizeof(Record), n * sizeof(Record), chunk.data(), what);
    for (std::size_t i = 0; i < n; ++i) store(begin + i, chunk[i]);
  }
}

void check_array(const ByteSource& source, const Contents& h, std::uint32_t offset, std::uint64_t bytes, const char* what) {
  if (offset < h.header_bytes)
    throw Error(source.name(), "header", fmt::format("{} said to begin at byte {}, inside the header", what, offset),
                "the file is damaged; export it again");
  source.require(offset, bytes, what);
}

// Everything that is present, before anything is allocated.
void check_sizes(const ByteSource& source, const Contents& h) {
  const auto bad = [&](const std::string& problem) {
    throw Error(source.name(), "header", problem, "the file is damaged; export it again");
  };
  if (h.strands > 0 && h.points_per_strand == 0) bad(fmt::format("{} strands of 0 points announced", h.strands));
  if (h.points() > UINT32_MAX)
    bad(fmt::format("{} strands of {} points announced, more than 2^32 points", h.strands, h.points_per_strand));
  check_array(source, h, h.positions, h.points() * h.position_bytes, "point array");
  if (h.strand_uv) check_array(source, h, h.strand_uv, h.strands * sizeof(Vec2), "strand uv array");
  if (h.strand_thickness) check_array(source, h, h.strand_thickness, h.strands * sizeof(float), "strand thickness array");
  if (h.vertex_color) check_array(source, h, h.vertex_color, h.points() * sizeof(Vec4), "vertex color array");
}

template <class Position>
void read_points(const ByteSource& source, const Contents& h, std::vector<Vec3>& points, const Progress& progress) {
  points.resize(h.points());
  for_each_record<Position>(source, h.positions, points.size(), "point array", [&](std::size_t i, const Position& p) {
    points[i] = {p.x, p.y, p.z};  // w, where there is one, is the inverse mass of the simulation
    if (i % kChunk == 0) tell(progress, "io.read", static_cast<double>(i) / static_cast<double>(points.size()), source.name());
  });
}

FileStrands read_contents(const ByteSource& source, const Contents& h, const Progress& progress) {
  check_sizes(source, h);
  FileStrands file;
  StrandSet& set = file.strands;
  set.offsets.resize(h.strands + 1);
  for (std::uint64_t s = 0; s <= h.strands; ++s) set.offsets[s] = static_cast<std::uint32_t>(s * h.points_per_strand);
  if (h.position_bytes == sizeof(Vec4)) read_points<Vec4>(source, h, set.points, progress);
  else read_points<Vec3>(source, h, set.points, progress);
  if (h.strand_uv) {
    set.root_uv.resize(h.strands);
    for_each_record<Vec2>(source, h.strand_uv, h.strands, "strand uv array",
                          [&](std::size_t s, Vec2 uv) { set.root_uv[s] = uv; });
  }
  if (h.strand_thickness) {
    set.widths.resize(h.points());
    for_each_record<float>(source, h.strand_thickness, h.strands, "strand thickness array", [&](std::size_t s, float width) {
      std::fill(set.widths.begin() + set.offsets[s], set.widths.begin() + set.offsets[s + 1], width);
    });
  }
  if (h.vertex_color) {
    set.colors.resize(h.points());
    for_each_record<Vec4>(source, h.vertex_color, h.points(), "vertex color array", [&](std::size_t i, const Vec4& c) {
      set.colors[i] = {c.x, c.y, c.z};
    });
    file.notes.emplace_back("the alpha of the vertex colors was ignored");
  }
  if (h.vertex_uv) file.notes.emplace_back("texture coordinates along the strands were ignored");
  return file;
}

FileStrands read(const ByteSource& source, const Progress& progress) {
  const Header h = source.get<Header>(0, "header");
  return read_contents(source,
                       {h.strands, h.points_per_strand, sizeof(Header), sizeof(Vec4), h.positions, h.strand_uv,
                        h.strand_thickness, h.vertex_color, h.vertex_uv},
                       progress);
}

FileStrands read3(const ByteSource& source, const Progress& progress) {
  const Header3 h = source.get<Header3>(0, "header");
  FileStrands file = read_contents(source,
                                   {h.strands, h.points_per_strand, sizeof(Header3), sizeof(Vec3), h.positions, h.strand_uv,
                                    h.strand_thickness, h.vertex_color, h.vertex_uv},
                                   progress);
  if (h.guide_strand) file.notes.emplace_back("guide indices were ignored");
  if (h.follow_strands)
    file.notes.push_back(fmt::format("the file asks for {} more strands around each; only its own are here", h.follow_strands));
  return file;
}

std::uint32_t uniform_count(const AtomicFile& file, const StrandSet& set) {
  const std::uint32_t count = set.offsets[1] - set.offsets[0];
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    if (set.offsets[s + 1] - set.offsets[s] != count)
      throw Error(file.path(), fmt::format("strand {}", s),
                  fmt::format("{} points where strand 0 has {}; TressFX wants the same number everywhere",
                              set.offsets[s + 1] - set.offsets[s], count),
                  "write .hair or .pelage, or resample the strands");
  return count;
}

std::vector<std::string> write(AtomicFile& file, const StrandSet& set, const Progress& progress) {
  const std::size_t n = set.strand_count(), count = set.point_count();
  Header h = {};
  h.version = 4;
  h.strands = static_cast<std::uint32_t>(n);
  h.points_per_strand = uniform_count(file, set);
  std::uint64_t end = sizeof(Header);
  const auto place = [&](bool present, std::uint64_t bytes) {
    const std::uint64_t begin = present ? end : 0;
    if (present) end += bytes;
    if (end > UINT32_MAX) throw Error(file.path(), "", "TressFX cannot hold more than 4 GiB", "write .pelage");
    return static_cast<std::uint32_t>(begin);
  };
  h.positions = place(true, count * sizeof(Vec4));
  h.strand_uv = place(!set.root_uv.empty(), n * sizeof(Vec2));
  h.strand_thickness = place(!set.widths.empty(), n * sizeof(float));
  h.vertex_color = place(!set.colors.empty(), count * sizeof(Vec4));
  file.put(h);

  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = set.points[i];
    // The simulation holds the first two points of a strand: inverse mass 0.
    file.put(Vec4(p.x, p.y, p.z, i % h.points_per_strand < 2 ? 0.f : 1.f));
    if (i % kChunk == 0) tell(progress, "io.write", static_cast<double>(i) / static_cast<double>(count), file.path());
  }
  file.write(set.root_uv.data(), set.root_uv.size() * sizeof(Vec2));
  if (!set.widths.empty())
    for (std::size_t s = 0; s < n; ++s) file.put(set.width(set.offsets[s]));
  const bool per_point = set.colors.size() == count;
  for (std::size_t i = 0; i < count && !set.colors.empty(); ++i) {
    const Vec3 c = set.colors[per_point ? i : i / h.points_per_strand];
    file.put(Vec4(c.x, c.y, c.z, 1));
  }

  std::vector<std::string> lost;
  report_lost(set, kStrandWidths | kPointColors | kRootUv, ".tfx", lost);
  if (!set.comment.empty()) lost.emplace_back(".tfx cannot hold the comment");
  return lost;
}

}  // namespace

const StrandFormat kTressFx = {
    {"tressfx", "TressFX 4 binary, Y up, any unit; every strand has as many points", {"tfx"}, true, true},
    mismatch<4>,
    read,
    write};
const StrandFormat kTressFx3 = {
    {"tressfx3", "TressFX 3 binary, Y up, any unit", {"tfx"}, true, false}, mismatch<3>, read3, nullptr};

}  // namespace pelage::io
