// The `.data` strands of USC-HairSalon and Hair20k (first used by Hair Photobooth, 2008): docs/formats.md.
// i32 strands; per strand i32 m and m points of three floats. No magic: the counts have to fit the file's size exactly.
#include <pelage/error.h>

#include <fmt/format.h>

#include "io/strand_formats.h"
#include "io/told.h"

namespace pelage::io {
namespace {

struct Counted {
  std::string mismatch;  // empty: strands and size agree
  std::size_t strands = 0, points = 0, bald = 0;
};

// Walks the file from count to count, calling visit(strand, m, byte of its points).
template <class Visit>
Counted walk(const ByteSource& source, const Visit& visit) {
  Counted found;
  if (source.size() < 4) return {"shorter than its strand count"};
  const auto strands = source.get<std::int32_t>(0, "strand count");
  if (strands < 0 || std::uint64_t(strands) * 4 > source.size() - 4)
    return {fmt::format("{} strands announced in {} bytes", strands, source.size())};
  std::uint64_t at = 4;
  for (std::int32_t s = 0; s < strands; ++s) {
    if (source.size() - at < 4) return {fmt::format("the file ends at byte {}, before strand {}", source.size(), s)};
    const auto m = source.get<std::int32_t>(at, "point count");
    at += 4;
    if (m < 0 || std::uint64_t(m) * sizeof(Vec3) > source.size() - at)
      return {fmt::format("strand {} at byte {} announces {} points, {} bytes are left", s, at - 4, m, source.size() - at)};
    visit(static_cast<std::size_t>(s), static_cast<std::uint32_t>(m), at);
    at += std::uint64_t(m) * sizeof(Vec3);
    found.bald += m == 1;
    if (m != 1) ++found.strands, found.points += static_cast<std::size_t>(m);
  }
  if (at != source.size()) found.mismatch = fmt::format("{} bytes follow the last strand", source.size() - at);
  return found;
}

std::string mismatch(const ByteSource& source) {
  return walk(source, [](std::size_t, std::uint32_t, std::uint64_t) {}).mismatch;
}

FileStrands read(const ByteSource& source, const Progress& progress) {
  const Counted found = walk(source, [](std::size_t, std::uint32_t, std::uint64_t) {});
  if (!found.mismatch.empty()) throw Error(source.name(), "", found.mismatch, "the file is damaged; export it again");
  if (found.points > UINT32_MAX) throw Error(source.name(), "", "more than 2^32 points", "split the groom");

  FileStrands file;
  StrandSet& set = file.strands;
  set.offsets.reserve(found.strands + 1);
  set.offsets.push_back(0);
  set.points.resize(found.points);
  if (found.bald) set.strand_id.reserve(found.strands);
  walk(source, [&](std::size_t s, std::uint32_t m, std::uint64_t at) {
    if (m == 1) return;
    const std::size_t begin = set.offsets.back();
    source.read(at, m * sizeof(Vec3), set.points.data() + begin, "points of a strand");
    set.offsets.push_back(static_cast<std::uint32_t>(begin + m));
    if (found.bald) set.strand_id.push_back(static_cast<std::uint32_t>(s));
    if (s % 1024 == 0) tell(progress, "io.read", static_cast<double>(at) / static_cast<double>(source.size()), source.name());
  });
  if (found.bald)
    file.notes.push_back(
        fmt::format("{} bald roots (strands of one point) were skipped; strand ids keep the numbering "
                    "of the file",
                    found.bald));
  return file;
}

std::vector<std::string> write(AtomicFile& file, const StrandSet& set, const Progress& progress) {
  if (set.strand_count() > INT32_MAX)
    throw Error(file.path(), "", "more than 2^31 strands do not fit a .data file", "write .pelage");
  file.put(static_cast<std::int32_t>(set.strand_count()));
  for (std::size_t s = 0; s < set.strand_count(); ++s) {
    const std::uint32_t begin = set.offsets[s], m = set.offsets[s + 1] - begin;
    file.put(static_cast<std::int32_t>(m));
    file.write(set.points.data() + begin, m * sizeof(Vec3));
    if (s % 4096 == 0)
      tell(progress, "io.write", static_cast<double>(s) / static_cast<double>(set.strand_count()), file.path());
  }
  std::vector<std::string> lost;
  report_lost(set, 0, ".data", lost);
  return lost;
}

}  // namespace

const StrandFormat kUsc = {
    {"usc", "USC-HairSalon and Hair20k strands, Y up, any unit", {"data"}, true, true}, mismatch, read, write};

}  // namespace pelage::io
