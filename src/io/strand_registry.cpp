#include "io/strand_registry.h"

#include <pelage/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "io/strand_formats.h"

namespace pelage::io {
namespace {

struct Foreign {
  std::string_view magic, name;
};
// Files that people do hand to a hair renderer; a name helps more than "unknown".
constexpr Foreign kForeign[] = {
    {"Ogawa", "an Alembic file"},
    {"\x89HDF\r\n\x1a\n", "an HDF5 file (Alembic before 1.5 wrote these)"},
    {"PXR-USDC", "a USD crate file"},
    {"#usda", "a USD text file"},
    {"PK\x03\x04", "a zip archive (.npz, .usdz)"},
    {"\x93NUMPY", "a NumPy array"},
    {"\x80\xBF\x80\x46IBER", "a Tungsten fiber file"},
    {"BINARY_HAIR", "a Mitsuba 0.6 hair file"},
    {"version 2", "a TressFX 2 text file"},
    {"ply\n", "a PLY file (a mesh or a point cloud)"},
    {"ply\r\n", "a PLY file (a mesh or a point cloud)"},
    {"glTF", "a binary glTF file (a mesh)"},
    {"//Maya ASCII", "a Maya scene"},
    {"\x89PNG", "a PNG image"},
    {"\x76\x2f\x31\x01", "an OpenEXR image"},
    {"#?RADIANCE", "a Radiance HDR image"},
};

bool begins_with(const ByteSource& source, std::string_view magic) {
  if (source.size() < magic.size()) return false;
  std::string head(magic.size(), '\0');
  source.read(0, head.size(), head.data(), "magic");
  return head == magic;
}

// Foreign formats without a magic number, known by how their counts explain the file's size.
std::string_view headerless_name(const ByteSource& source) {
  if (source.size() < 8) return "";
  const std::uint64_t n = source.get<std::uint32_t>(0, "count"), second = source.get<std::uint32_t>(4, "count");
  if (n > 0 && source.size() == 8 + 2 * n + 12 * second) {
    std::uint64_t points = 0;
    for (std::uint64_t s = 0; s < n; ++s) points += source.get<std::uint16_t>(8 + 2 * s, "count");
    if (points == second) return "a MonoHair .hair file";
  }
  constexpr std::uint64_t kPoint = 28;  // position, normal, label
  std::uint64_t at = 4, strands = 0;
  for (; strands < n && source.size() - at >= 4; ++strands) {
    const std::uint64_t m = source.get<std::uint32_t>(at, "count");
    if (m > (source.size() - at - 4) / kPoint) return "";
    at += 4 + kPoint * m;
  }
  return n > 0 && strands == n && at == source.size() ? "a CT2Hair .bin file" : "";
}

}  // namespace

const std::vector<const StrandFormat*>& strand_registry() {
  static const std::vector<const StrandFormat*> formats = {&kPelage, &kCyHair, &kTressFx, &kTressFx3, &kUsc};
  return formats;
}

const StrandFormat& detect_strand_format(const ByteSource& source) {
  if (source.size() == 0) throw Error(source.name(), "", "an empty file", "export the groom again");
  std::string tried;
  for (const StrandFormat* format : strand_registry()) {
    const std::string why_not = format->mismatch(source);
    if (why_not.empty()) return *format;
    tried += fmt::format("{}{}: {}", tried.empty() ? "" : "; ", format->info.name, why_not);
  }
  for (const Foreign& foreign : kForeign)
    if (begins_with(source, foreign.magic))
      throw Error(source.name(), "", fmt::format("this is {}; not supported yet as a groom", foreign.name),
                  "export .hair, .tfx or .data");
  if (const std::string_view name = headerless_name(source); !name.empty())
    throw Error(source.name(), "", fmt::format("this looks like {}; not supported yet", name), "export .hair or .data");
  throw Error(source.name(), "", "not a groom in any known format", tried);
}

void report_lost(const StrandSet& set, unsigned kept, std::string_view format, std::vector<std::string>& lost) {
  const auto lose = [&](bool present, std::string_view what) {
    if (present) lost.push_back(fmt::format("{} cannot hold {}", format, what));
  };
  const bool varying = set.widths.size() > 1;
  if (!(kept & kWidths)) lose(varying, kept & kStrandWidths ? "widths that vary along a strand" : "widths");
  lose(!(kept & kPointColors) && !set.colors.empty(), "colors");
  lose(!(kept & kTransparencies) && !set.transparency.empty(), "transparency");
  lose(!(kept & kRootUv) && !set.root_uv.empty(), "root texture coordinates");
  lose(!set.strand_id.empty(), "strand ids");
  lose(!set.guide_id.empty(), "guide ids");
  lose(!set.group.empty(), "groups");
  lose(set.basis != CurveBasis::kCatmullRom, "the curve basis (it will be read as Catmull-Rom)");
}

}  // namespace pelage::io
