#include <pelage/error.h>
#include <pelage/hair_mesh.h>

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace pelage {
namespace {

/// Largest values of a kind's numbers; all start at 0 but where `least` says otherwise.
struct Ranges {
  float amount, frequency, start, variation;
  float least_amount = 0, least_frequency = 0;
};

constexpr std::array<Ranges, StyleOperator::kKinds> kRanges{{
    {2, 0, 0, 1, 0.05f},  // length
    {1, 32, 1, 1, 0, 1},  // clump
    {1, 64, 1, 1},        // braid
    {0.1f, 128, 1, 1},    // wave
    {0.1f, 128, 1, 1},    // curl
    {0.1f, 64, 1, 1},     // noise
    {0.1f, 128, 1, 1},    // frizz
    {1, 0, 1, 1},         // taper
}};

// Names the first broken rule; validate() is the list of them.
class Validator {
 public:
  Validator(const HairMesh& mesh, const std::string& where) : mesh_(mesh), where_(where) {}

  void columns() const {
    const std::vector<std::uint32_t>& offsets = mesh_.column_offsets;
    if (mesh_.vertex_count() > HairMesh::kMaxVertices)
      fail("vertices", fmt::format("{} of them", mesh_.vertex_count()), fmt::format("{} at most", HairMesh::kMaxVertices));
    if (offsets.size() < 2) fail("columns", "there are none", "a bundle stands between four");
    if (offsets.front() != 0) fail("column_offsets", fmt::format("the first is {}", offsets.front()), "it is 0");
    for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
      if (offsets[c + 1] < offsets[c]) fail(at("column", c), "its offset lies after the next column's", "offsets grow");
      const std::uint32_t layers = offsets[c + 1] - offsets[c];
      if (layers < 2 || layers > HairMesh::kMaxLayers)
        fail(at("column", c), fmt::format("{} layers", layers), fmt::format("2…{}", HairMesh::kMaxLayers));
    }
    if (offsets.back() != mesh_.vertex_count())
      fail("column_offsets", fmt::format("the last is {}, but there are {} vertices", offsets.back(), mesh_.vertex_count()),
           "it is the number of vertices");
  }

  void vertices() const {
    size(mesh_.tangents, "tangents", true), size(mesh_.uvw, "uvw", false), size(mesh_.occlusion, "occlusion", true);
    values(mesh_.positions, "positions", fmt::format("finite and within {} m", kMaxPosition), in_space);
    values(mesh_.tangents, "tangents", fmt::format("finite and within {} m", kMaxPosition), in_space);
    values(mesh_.uvw, "uvw", "0…1", [](Vec3 p) { return in_unit(p.x) && in_unit(p.y) && in_unit(p.z); });
    values(mesh_.occlusion, "occlusion", "0…1", in_unit);
    if (!(mesh_.width >= 0 && mesh_.width <= 0.1f)) fail("width", fmt::format("{} m", mesh_.width), "0…0.1 m");
  }

  void bundles() const {
    if (mesh_.bundles.empty()) fail("bundles", "there are none", "one at least");
    if (mesh_.bundles.size() > HairMesh::kMaxVertices)
      fail("bundles", fmt::format("{} of them", mesh_.bundles.size()), fmt::format("{} at most", HairMesh::kMaxVertices));
    for (std::size_t i = 0; i < mesh_.bundles.size(); ++i) bundle(at("bundle", i), mesh_.bundles[i]);
  }

  void styles() const {
    for (std::size_t s = 0; s < mesh_.styles.size(); ++s) {
      std::array<bool, StyleOperator::kKinds> seen{};
      for (const StyleOperator& o : mesh_.styles[s]) {
        const auto kind = static_cast<std::size_t>(o.kind);
        if (kind >= StyleOperator::kKinds) fail(at("style", s), fmt::format("operator kind {}", kind), "0…7");
        const std::string place = fmt::format("style {}: {}", s, style_operator_names()[kind]);
        if (seen[kind]) fail(place, "it stands there twice", "once in a style");
        seen[kind] = true;
        operator_numbers(place, o, kRanges[kind]);
      }
    }
  }

 private:
  static constexpr float kMaxPosition = 1e6f;
  static bool in_unit(float x) { return x >= 0 && x <= 1; }
  static bool in_space(Vec3 p) {
    const auto near = [](float x) { return std::fabs(x) <= kMaxPosition; };
    return near(p.x) && near(p.y) && near(p.z);
  }
  static std::string at(const char* what, std::size_t i) { return fmt::format("{} {}", what, i); }

  template <class T>
  void size(const std::vector<T>& array, const char* name, bool optional) const {
    if (array.size() == mesh_.vertex_count() || (optional && array.empty())) return;
    fail(name, fmt::format("{} entries for {} vertices", array.size(), mesh_.vertex_count()), "one a vertex");
  }

  template <class T, class Good>
  void values(const std::vector<T>& array, const char* name, const std::string& rule, const Good& good) const {
    for (std::size_t i = 0; i < array.size(); ++i)
      if (!good(array[i])) fail(fmt::format("{}[{}]", name, i), "out of range", rule);
  }

  void bundle(const std::string& place, const HairMesh::Bundle& b) const {
    for (const std::uint32_t c : b.columns)
      if (c >= mesh_.column_count())
        fail(place, fmt::format("column {}", c), fmt::format("there are {}", mesh_.column_count()));
    for (const std::uint32_t c : b.columns)
      if (mesh_.column_offsets[c + 1] - mesh_.column_offsets[c] != mesh_.layers(b))
        fail(place, "its columns differ in layers", "four columns of equally many");
    if (b.strands < 1 || b.strands > HairMesh::kMaxStrands)
      fail(place, fmt::format("{} strands", b.strands), fmt::format("1…{}", HairMesh::kMaxStrands));
    if (b.style >= mesh_.styles.size())
      fail(place, fmt::format("style {}", b.style), fmt::format("there are {}", mesh_.styles.size()));
  }

  void operator_numbers(const std::string& place, const StyleOperator& o, const Ranges& r) const {
    const auto require = [&](const char* name, float value, float least, float most) {
      if (!(value >= least && value <= most)) fail(place, fmt::format("{} {}", name, value), fmt::format("{}…{}", least, most));
    };
    require("amount", o.amount, r.least_amount, r.amount);
    require("frequency", o.frequency, r.least_frequency, r.frequency);
    require("start", o.start, 0, r.start);
    require("variation", o.variation, 0, r.variation);
    if (o.kind == StyleOperator::Kind::kClump && o.frequency != std::floor(o.frequency))
      fail(place, fmt::format("frequency {}", o.frequency), "a whole number of clumps");
  }

  [[noreturn]] void fail(const std::string& place, const std::string& problem, const std::string& rule) const {
    throw Error(where_, place, problem, rule);
  }
  const HairMesh& mesh_;
  const std::string& where_;
};

}  // namespace

void validate(const HairMesh& mesh, const std::string& where) {
  const Validator v(mesh, where);
  v.columns();
  v.vertices();
  v.bundles();
  v.styles();
}

const std::vector<std::string>& style_operator_names() {
  static const std::vector<std::string> names{"length", "clump", "braid", "wave", "curl", "noise", "frizz", "taper"};
  return names;
}

}  // namespace pelage
