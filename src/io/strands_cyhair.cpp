// cyHAIR, the `.hair` of Cem Yuksel's hair models (cemyuksel.com/research/hairmodels): docs/formats.md.
#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/strand_formats.h"
#include "io/told.h"

namespace pelage::io {
namespace {

struct Header {
  char magic[4];
  std::uint32_t strands, points, flags, default_segments;
  float default_thickness, default_transparency, default_color[3];
  char info[88];
};
static_assert(sizeof(Header) == 128);

enum Flag : std::uint32_t { kHasSegments = 1, kHasPoints = 2, kHasThickness = 4, kHasTransparency = 8, kHasColors = 16 };
constexpr std::uint32_t kMaxSegments = 65535;
// Written into the info text; read back so that our own files need no guess.
constexpr const char* kUnitsNote = "unit=m up=z";
constexpr std::size_t kChunk = 4 << 20;  // bytes between two words of progress

std::string mismatch(const ByteSource& source) {
  if (source.size() < 4) return "shorter than its magic number";
  return source.get<std::array<char, 4>>(0, "magic") == std::array{'H', 'A', 'I', 'R'} ? "" : "does not begin with HAIR";
}

// Where each array begins; the file's size follows from the header alone.
struct Layout {
  std::uint64_t segments, points, thickness, transparency, colors, end;
  explicit Layout(const Header& h) {
    const std::uint64_t n = h.strands, p = h.points;
    segments = sizeof(Header);
    points = segments + (h.flags & kHasSegments ? 2 * n : 0);
    thickness = points + 12 * p;
    transparency = thickness + (h.flags & kHasThickness ? 4 * p : 0);
    colors = transparency + (h.flags & kHasTransparency ? 4 * p : 0);
    end = colors + (h.flags & kHasColors ? 12 * p : 0);
  }
};

void check_sizes(const ByteSource& source, const Header& h, const Layout& at) {
  const auto bad = [&](const char* place, std::string problem) {
    throw Error(source.name(), place, std::move(problem), "the file is damaged; export it again");
  };
  if (!(h.flags & kHasPoints)) bad("header flags", "no point array (bit 1 of the flags is off)");
  if (!(h.flags & kHasSegments) && std::uint64_t{h.strands} * (std::uint64_t{h.default_segments} + 1) != h.points)
    bad("header", fmt::format("{} strands of {} segments do not make {} points", h.strands, h.default_segments, h.points));
  source.require(at.segments, at.points - at.segments, "segment counts");
  source.require(at.points, at.thickness - at.points, "point array");
  source.require(at.thickness, at.transparency - at.thickness, "thickness array");
  source.require(at.transparency, at.colors - at.transparency, "transparency array");
  source.require(at.colors, at.end - at.colors, "color array");
}

void read_offsets(const ByteSource& source, const Header& h, std::uint64_t begin, std::vector<std::uint32_t>& offsets) {
  offsets.resize(std::size_t{h.strands} + 1);
  std::vector<std::uint16_t> segments(std::min<std::size_t>(h.strands, kChunk / 2));
  std::uint64_t sum = 0;
  for (std::uint32_t s = 0; s < h.strands; ++s) {
    const std::size_t in_chunk = s % std::max<std::size_t>(segments.size(), 1);
    if ((h.flags & kHasSegments) && in_chunk == 0)
      source.read(begin + 2 * std::uint64_t{s}, 2 * std::min<std::size_t>(segments.size(), h.strands - s), segments.data(),
                  "segment counts");
    const std::uint64_t count = (h.flags & kHasSegments ? segments[in_chunk] : h.default_segments) + std::uint64_t{1};
    if (sum + count > h.points)
      throw Error(source.name(), fmt::format("strand {}", s),
                  fmt::format("{} points announced, {} present", count, h.points - sum),
                  "segment counts and point count disagree; export it again");
    sum += count;
    offsets[s + 1] = static_cast<std::uint32_t>(sum);
  }
  if (sum != h.points)
    throw Error(source.name(), "segment counts", fmt::format("they make {} points, the header says {}", sum, h.points),
                "the file is damaged; export it again");
}

template <class T>
void read_array(const ByteSource& source, std::uint64_t begin, std::size_t count, std::vector<T>& array, const char* what,
                const Progress& progress) {
  array.resize(count);
  for (std::size_t i = 0; i < count; i += kChunk / sizeof(T)) {
    const std::size_t n = std::min(kChunk / sizeof(T), count - i);
    source.read(begin + i * sizeof(T), n * sizeof(T), array.data() + i, what);
    tell(progress, "io.read", static_cast<double>(begin + (i + n) * sizeof(T)) / static_cast<double>(source.size()),
         source.name());
  }
}

FileStrands read(const ByteSource& source, const Progress& progress) {
  const Header h = source.get<Header>(0, "header");
  const Layout at(h);
  check_sizes(source, h, at);

  FileStrands file;
  StrandSet& set = file.strands;
  const char* text_end = std::find(h.info, h.info + sizeof h.info, '\0');
  set.comment.assign(h.info, text_end);
  read_offsets(source, h, at.segments, set.offsets);
  read_array(source, at.points, h.points, set.points, "point array", progress);
  if (h.flags & kHasThickness) {
    read_array(source, at.thickness, h.points, set.widths, "thickness array", progress);
  } else {
    set.widths.assign(1, h.default_thickness);
    file.width_is_fallback = true;
  }
  if (h.flags & kHasTransparency)
    read_array(source, at.transparency, h.points, set.transparency, "transparency array", progress);
  else if (h.default_transparency > 0 && h.default_transparency <= 1) set.transparency.assign(h.points, h.default_transparency);
  if (h.flags & kHasColors) read_array(source, at.colors, h.points, set.colors, "color array", progress);

  file.up = UpAxis::kZ;
  file.up_varies = true;
  if (set.comment.ends_with(kUnitsNote)) {
    file.scale = 1;
    file.up_stated = true;
    set.comment.resize(set.comment.size() - std::string_view(kUnitsNote).size());
    if (set.comment.ends_with("; ")) set.comment.resize(set.comment.size() - 2);
  }
  if (source.size() > at.end)
    file.notes.push_back(fmt::format("{} bytes after the last array were ignored", source.size() - at.end));
  return file;
}

Header make_header(const StrandSet& set, std::vector<std::string>& lost) {
  Header h = {};
  std::copy_n("HAIR", 4, h.magic);
  h.strands = static_cast<std::uint32_t>(set.strand_count());
  h.points = static_cast<std::uint32_t>(set.point_count());
  h.flags = kHasSegments | kHasPoints;
  if (set.widths.size() > 1) h.flags |= kHasThickness;
  if (!set.transparency.empty()) h.flags |= kHasTransparency;
  if (!set.colors.empty()) h.flags |= kHasColors;
  h.default_thickness = set.widths.empty() ? 0 : set.widths[0];
  const std::string note = set.comment.empty() ? kUnitsNote : fmt::format("; {}", kUnitsNote);
  const std::size_t room = sizeof h.info - 1 - note.size();
  if (set.comment.size() > room) lost.push_back(fmt::format("the comment was cut to {} bytes", room));
  const std::string text = set.comment.substr(0, room) + note;
  std::copy(text.begin(), text.end(), h.info);
  return h;
}

// Y up to Z up: a quarter turn about x, exact in floats.
Vec3 z_up(Vec3 p) { return {p.x, -p.z, p.y}; }

std::vector<std::string> write(AtomicFile& file, const StrandSet& set, const Progress& progress) {
  std::vector<std::string> lost;
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    if (set.offsets[s + 1] - set.offsets[s] > kMaxSegments + 1)
      throw Error(
          file.path(), fmt::format("strand {}", s),
          fmt::format("{} points; a .hair strand holds at most {}", set.offsets[s + 1] - set.offsets[s], kMaxSegments + 1),
          "write .pelage");
  file.put(make_header(set, lost));
  for (std::size_t s = 0; s < set.strand_count(); ++s)
    file.put(static_cast<std::uint16_t>(set.offsets[s + 1] - set.offsets[s] - 1));
  for (std::size_t i = 0; i < set.point_count(); ++i) {
    file.put(z_up(set.points[i]));
    if (i % (1 << 18) == 0)
      tell(progress, "io.write", static_cast<double>(i) / static_cast<double>(set.point_count()), file.path());
  }
  if (set.widths.size() > 1) file.write(set.widths.data(), set.widths.size() * sizeof(float));
  file.write(set.transparency.data(), set.transparency.size() * sizeof(float));
  if (set.colors.size() == set.point_count()) {
    file.write(set.colors.data(), set.colors.size() * sizeof(Vec3));
  } else if (!set.colors.empty()) {
    for (std::size_t s = 0; s < set.strand_count(); ++s)
      for (std::uint32_t i = set.offsets[s]; i < set.offsets[s + 1]; ++i) file.put(set.colors[s]);
  }
  report_lost(set, kWidths | kTransparencies | kPointColors, ".hair", lost);
  return lost;
}

}  // namespace

const StrandFormat kCyHair = {{"cyhair", "cyHAIR strands, Z up, any unit", {"hair"}, true, true}, mismatch, read, write};

}  // namespace pelage::io
