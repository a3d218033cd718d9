#include "frame/hair_samples.h"

#include <fmt/format.h>
#include <pelage/error.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "core/nearest.h"
#include "core/parallel.h"

namespace pelage {
namespace {

constexpr std::size_t kPixelsPerTask = 1 << 14;
constexpr float kNothing = 1e9f;  // depths from here on are those of renderers that have no infinity
constexpr float kRounding = 1e-3f;

const std::vector<std::string> kXyz{"X", "Y", "Z"}, kRgb{"R", "G", "B"};
/// What renderers call the component of a field of one channel.
const std::vector<std::string> kSingle{"X", "R", "V", "Z", "A"};

const GBufferField& field_of(const std::string& name) {
  const auto& fields = gbuffer_fields();
  const auto field = std::find_if(fields.begin(), fields.end(), [&](const GBufferField& f) { return f.name == name; });
  if (field != fields.end()) return *field;
  std::vector<std::string> names;
  for (const GBufferField& f : fields) names.push_back(f.name);
  throw Error("G-buffer", name, fmt::format("no such field; did you mean {}?", nearest_name(name, names)), "");
}

/// Finds fields in a picture and reads them.
class Reader {
 public:
  Reader(const Image& image, const std::map<std::string, std::string>& names) : image_(image), names_(names) {
    for (const auto& [own, theirs] : names) {
      const GBufferField& field = field_of(own);
      if (places(field).empty()) throw missing(field);
    }
  }

  bool has(const std::string& name) const { return !places(field_of(name)).empty(); }

  template <class T, class Make>
  void read(const std::string& name, Buffer<T>& out, const Make& make) const {
    const GBufferField& field = field_of(name);
    const std::vector<std::size_t> at = places(field);
    if (at.empty()) throw missing(field);
    const std::size_t stride = image_.channel_count();
    out.resize(image_.pixels.size() / stride);
    parallel_for(out.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        out[p] = make([&](std::size_t component) { return image_.pixels[p * stride + at[component]]; });
    });
  }
  void read(const std::string& name, Buffer<float>& out) const {
    read(name, out, [](const auto& at) { return at(0); });
  }
  void read(const std::string& name, Buffer<Vec3>& out) const {
    read(name, out, [](const auto& at) { return Vec3(at(0), at(1), at(2)); });
  }

 private:
  std::optional<std::size_t> place(const std::string& channel) const {
    const auto found = std::find(image_.channels.begin(), image_.channels.end(), channel);
    if (found == image_.channels.end()) return std::nullopt;
    return static_cast<std::size_t>(found - image_.channels.begin());
  }

  /// Of all channels `prefix` + component; none where one is missing.
  std::vector<std::size_t> places(const std::string& prefix, const std::vector<std::string>& components) const {
    std::vector<std::size_t> at;
    for (const std::string& component : components)
      if (const auto i = place(prefix + component)) at.push_back(*i);
    return at.size() == components.size() ? at : std::vector<std::size_t>{};
  }

  std::vector<std::size_t> places(const GBufferField& field) const {
    const auto renamed = names_.find(field.name);
    const std::size_t count = std::max<std::size_t>(1, field.components.size());
    if (renamed == names_.end())
      return field.name == "color" || field.name == "alpha" || field.name == "depth" ? places("", field.components)
                                                                                     : places(field, field.name);
    if (count == 1) {
      if (const auto i = place(renamed->second)) return {*i};
      for (const std::string& component : kSingle)
        if (const auto i = place(renamed->second + "." + component)) return {*i};
      return {};
    }
    return places(field, renamed->second);
  }

  std::vector<std::size_t> places(const GBufferField& field, const std::string& name) const {
    if (field.components.empty()) return places(name, {""});
    std::vector<std::size_t> at = places(name + ".", field.components);
    const bool vector = field.components == kXyz || field.components == kRgb;
    if (at.empty() && vector) at = places(name + ".", field.components == kXyz ? kRgb : kXyz);
    return at;
  }

  Error missing(const GBufferField& field) const {
    const auto renamed = names_.find(field.name);
    std::string wanted = field.name;
    if (renamed != names_.end()) wanted = fmt::format("{} (for {})", renamed->second, field.name);
    std::string there;
    for (const std::string& channel : image_.channels) {
      if (there.size() > 400) {
        there += ", …";
        break;
      }
      there += (there.empty() ? "" : ", ") + channel;
    }
    return Error("G-buffer", "channel " + wanted, fmt::format("is not there: {}", field.meaning),
                 fmt::format("where it has another name, say --channel {}=NAME; there are {}", field.name, there));
  }

  const Image& image_;
  const std::map<std::string, std::string>& names_;
};

/// Names the first pixel, from the top left, at which `bad` holds.
template <class Bad>
void require(const HairSamples& s, const char* field, const char* problem, const char* remedy, const Bad& bad) {
  std::atomic<std::size_t> first{s.strand.size()};
  parallel_for(s.strand.size(), kPixelsPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      if (!bad(p)) continue;
      std::size_t now = first.load();
      while (p < now && !first.compare_exchange_weak(now, p)) {
      }
      return;
    }
  });
  const std::size_t p = first, width = static_cast<std::size_t>(s.width);
  if (p < s.strand.size())
    throw Error("G-buffer", fmt::format("{} at pixel ({}, {})", field, p % width, p / width), problem, remedy);
}

bool finite(Vec4 v) { return is_finite({v.x, v.y, v.z}) && std::isfinite(v.w); }

void check(const HairSamples& s) {
  const char* const not_finite = "is not a finite number";
  const char* const again = "render it again; look for values that are not finite in lights, materials and textures";
  require(s, "strand", not_finite, "0 where there is no hair, else a number of its own for every strand",
          [&](std::size_t p) { return !std::isfinite(s.strand[p]) || (!s.groom.empty() && !std::isfinite(s.groom[p])); });
  require(s, "color", not_finite, again, [&](std::size_t p) { return !is_finite(s.color[p]) || !std::isfinite(s.alpha[p]); });
  require(s, "depth", "is not a number", again, [&](std::size_t p) { return std::isnan(s.depth[p]); });
  require(s, "depth", "hair has none", "a positive number wherever `strand` is not 0, infinity or 0 where nothing is hit",
          [&](std::size_t p) { return s.is_hair(p) && !(s.depth[p] < INFINITY); });
  require(s, "u", "is not between 0 and 1", "0 at the root, 1 at the tip of every strand",
          [&](std::size_t p) { return s.is_hair(p) && !(s.u[p] >= -kRounding && s.u[p] <= 1 + kRounding); });
  require(s, s.on_screen ? "screen" : "tangent", not_finite, again,
          [&](std::size_t p) { return s.is_hair(p) && !is_finite(s.tangent[p]); });
  require(s, "position", not_finite, again, [&](std::size_t p) { return s.is_hair(p) && !is_finite(s.position[p]); });
  if (!s.background.empty())
    require(s, "background", not_finite, again, [&](std::size_t p) { return !finite(s.background[p]); });
  if (!s.thickness.empty())
    require(s, "thickness", "is not a number ≥ 0", "the diameter of the strand in pixels",
            [&](std::size_t p) { return s.is_hair(p) && !(s.thickness[p] >= 0 && s.thickness[p] < kNothing); });
  if (!s.coverage.empty())
    require(s, "coverage", "is not between 0 and 1", "the share of the pixel that hair covers",
            [&](std::size_t p) { return !(s.coverage[p] >= -kRounding && s.coverage[p] <= 1 + kRounding); });
}

void read_geometry(const Reader& reader, HairSamples& s) {
  s.on_screen = reader.has("screen");
  if (s.on_screen) {
    reader.read("screen", s.tangent, [](const auto& at) { return Vec3(at(0), at(1), 0); });
    s.position.resize(s.tangent.size());
    const auto width = static_cast<std::size_t>(s.width);
    for (std::size_t p = 0; p < s.position.size(); ++p)
      s.position[p] = {static_cast<float>(p % width) + 0.5f, static_cast<float>(p / width) + 0.5f, 0};
    return;
  }
  reader.read("tangent", s.tangent);
  reader.read("position", s.position);
}

void read_background(const Reader& reader, HairSamples& s) {
  reader.read("background", s.background, [](const auto& at) { return Vec4(at(0), at(1), at(2), 1); });
  if (!reader.has("background.A")) return;
  Buffer<float> alpha;
  reader.read("background.A", alpha);
  for (std::size_t p = 0; p < alpha.size(); ++p) s.background[p].w = alpha[p];
}

}  // namespace

const std::vector<GBufferField>& gbuffer_fields() {
  static const std::vector<GBufferField> kFields{
      {"color", {"R", "G", "B"}, true, "linear radiance of what the pixel's one sample sees; of hair without its background"},
      {"depth",
       {"Z"},
       true,
       "distance of what the sample sees, along the view or the ray, any unit; 0, infinite or from 1e9 on: nothing"},
      {"strand",
       {},
       true,
       "0 where there is no hair, else a number of its own for every strand; with --groom from 1 in the file's order"},
      {"u", {}, true, "place along the strand, 0 at the root, 1 at the tip"},
      {"tangent", kXyz, false, "direction of the strand, any length, in the space of `position`; or `screen`"},
      {"position", kXyz, false, "place of the sample in world, camera or object space, any unit; goes with `tangent`"},
      {"screen", {"X", "Y"}, false, "direction of the strand on the screen, x right, y down, any length; instead of `tangent`"},
      {"groom", {}, false, "numbers of grooms, where these number their strands alike; else 0"},
      {"alpha", {"A"}, false, "opacity of pixels without hair; else 1"},
      {"background", {"R", "G", "B"}, false, "what is behind the hair; else guessed from the pixels around"},
      {"background.A", {}, false, "its opacity, with which it is premultiplied; else 1"},
      {"coverage", {}, false, "share of the pixel that hair covers, of many samples or exact; for --alpha coverage"},
      {"thickness", {}, false, "diameter of the strand, pixels: thick strands are smoothed less; 0, or without it: thin"}};
  return kFields;
}

std::vector<TraceLayer> gbuffer_layers() {
  return {TraceLayer::kDepth, TraceLayer::kPosition, TraceLayer::kTangent, TraceLayer::kStrand, TraceLayer::kU};
}

std::uint64_t HairSamples::strand_key(std::size_t p) const {
  const float g = groom.empty() ? 0 : groom[p];
  return static_cast<std::uint64_t>(std::bit_cast<std::uint32_t>(g)) << 32 | std::bit_cast<std::uint32_t>(strand[p]);
}

HairSamples read_hair_samples(const Image& gbuffer, const std::map<std::string, std::string>& names) {
  const std::size_t pixels =
      static_cast<std::size_t>(std::max(0, gbuffer.width)) * static_cast<std::size_t>(std::max(0, gbuffer.height));
  if (pixels == 0 || pixels >= 0xffffffffu || gbuffer.pixels.size() != pixels * gbuffer.channel_count())
    throw Error("G-buffer", "",
                fmt::format("{} × {} pixels of {} channels with {} values", gbuffer.width, gbuffer.height,
                            gbuffer.channel_count(), gbuffer.pixels.size()),
                "1 to 2³² − 2 pixels are read");
  const Reader reader(gbuffer, names);
  HairSamples s;
  s.width = gbuffer.width, s.height = gbuffer.height;
  reader.read("color", s.color);
  if (reader.has("alpha")) reader.read("alpha", s.alpha);
  else s.alpha.resize(pixels), s.alpha.fill(1);
  reader.read("depth", s.depth, [](const auto& at) {
    const float z = at(0);
    return z <= 0 || z >= kNothing ? INFINITY : z;
  });
  reader.read("strand", s.strand);
  if (reader.has("groom")) reader.read("groom", s.groom);
  reader.read("u", s.u);
  read_geometry(reader, s);
  if (reader.has("background")) read_background(reader, s);
  if (reader.has("coverage")) reader.read("coverage", s.coverage);
  if (reader.has("thickness")) reader.read("thickness", s.thickness);
  check(s);
  return s;
}

}  // namespace pelage
