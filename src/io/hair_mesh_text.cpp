// The text file of a hair mesh: JSON, told as a table from which the reader and the schema both come.
#include <pelage/error.h>

#include <fmt/format.h>

#include <iterator>
#include <limits>
#include <string_view>

#include "io/hair_mesh_formats.h"

namespace pelage::io {
namespace {

constexpr long long kVersion = 1;
constexpr double kFar = 1e6;  // metres

// A column as the file has it; its arrays join those of the mesh.
struct ColumnText {
  std::vector<Vec3> positions, tangents, uvw;
  std::vector<float> occlusion;
};

struct MeshText {
  HairMesh mesh;
  std::vector<ColumnText> columns;
};

Field<ColumnText> vectors_field(std::string key, const char* about, std::vector<Vec3> ColumnText::*member, double least,
                                double most) {
  return {std::move(key),
          {{"description", about}, {"type", "array"}, {"items", vector_schema("x, y, z", least, most)}},
          [=](const JsonValue& v, ColumnText& out) {
            for (const JsonValue& element : v.elements()) (out.*member).push_back(element.vector(least, most));
          }};
}

const Fields<ColumnText>& column_fields() {
  static const Fields<ColumnText> table{
      vectors_field("positions", "A vertex a layer, meters, root first", &ColumnText::positions, -kFar, kFar).required(),
      vectors_field("tangents", "d position/d layer, meters; in all columns or in none", &ColumnText::tangents, -kFar, kFar),
      vectors_field("uvw", "Place in the groom; w is 0 at the root, 1 at the tip", &ColumnText::uvw, 0, 1).required(),
      {"occlusion",
       {{"description", "Share of the sky that each vertex sees; in all columns or in none"},
        {"type", "array"},
        {"items", {{"type", "number"}, {"minimum", 0}, {"maximum", 1}}}},
       [](const JsonValue& v, ColumnText& out) {
         for (const JsonValue& element : v.elements()) out.occlusion.push_back(static_cast<float>(element.number(0, 1)));
       }},
  };
  return table;
}

const Fields<HairMesh::Bundle>& bundle_fields() {
  using B = HairMesh::Bundle;
  constexpr long long kMost = static_cast<long long>(HairMesh::kMaxVertices) - 1;
  static const Fields<B> table{
      Field<B>{"columns",
               {{"description", "Its corners (u, v) = (0, 0), (1, 0), (1, 1), (0, 1)"},
                {"type", "array"},
                {"items", {{"type", "integer"}, {"minimum", 0}, {"maximum", kMost}}},
                {"minItems", 4},
                {"maxItems", 4}},
               [](const JsonValue& v, B& out) {
                 const std::vector<JsonValue> corners = v.elements();
                 if (corners.size() != 4) v.fail(fmt::format("{} columns where a bundle has 4", corners.size()));
                 for (std::size_t i = 0; i < 4; ++i) out.columns[i] = static_cast<std::uint32_t>(corners[i].integer(0, kMost));
               }}
          .required(),
      integer_field("strands", "At full detail", &B::strands, 1, HairMesh::kMaxStrands).required(),
      integer_field("style", "Which list of operators, from 0", &B::style, 0, kMost),
      integer_field("seed", "Of its random numbers", &B::seed, 0, std::numeric_limits<std::uint32_t>::max()),
  };
  return table;
}

const Fields<StyleOperator>& operator_fields() {
  using O = StyleOperator;
  static const Fields<O> table{
      Field<O>{"kind",
               {{"description", "What it does; docs/hair_meshes.md has the numbers of each"}, {"enum", style_operator_names()}},
               [](const JsonValue& v, O& out) { out.kind = static_cast<O::Kind>(choice_index(v, style_operator_names())); }}
          .required(),
      number_field("amount", "How much", &O::amount, 0, 2),
      number_field("frequency", "Waves, turns or clumps", &O::frequency, 0, 128),
      number_field("start", "w from which it sets in", &O::start, 0, 1),
      number_field("variation", "How much strands differ", &O::variation, 0, 1),
  };
  return table;
}

const Fields<MeshText>& mesh_fields() {
  static const Fields<MeshText> table{
      Field<MeshText>{"hair_mesh",
                      {{"description", "Version of the format; the first key"}, {"const", kVersion}},
                      [](const JsonValue& v, MeshText&) {
                        const long long version = v.integer(0, std::numeric_limits<int>::max());
                        if (version != kVersion)
                          v.fail(fmt::format("version {}; this program reads {}", version, kVersion), "use a newer Pelage");
                      }}
          .required(),
      {"$schema", {{"description", "For editors"}, {"type", "string"}}, [](const JsonValue& v, MeshText&) { v.text(); }},
      {"comment",
       {{"description", "Free text"}, {"type", "string"}},
       [](const JsonValue& v, MeshText& out) { out.mesh.comment = v.text(); }},
      {"width",
       {{"description", "Diameter of strands at the root, meters"}, {"type", "number"}, {"minimum", 0}, {"maximum", 0.1}},
       [](const JsonValue& v, MeshText& out) { out.mesh.width = static_cast<float>(v.number(0, 0.1)); }},
      Field<MeshText>{"styles",
                      {{"description", "Lists of operators, each applied in its order"},
                       {"type", "array"},
                       {"items", {{"type", "array"}, {"items", object_schema(operator_fields())}}}},
                      [](const JsonValue& v, MeshText& out) {
                        for (const JsonValue& style : v.elements()) {
                          auto& operators = out.mesh.styles.emplace_back();
                          for (const JsonValue& o : style.elements())
                            read_object(o, operator_fields(), operators.emplace_back());
                        }
                      }}
          .required(),
      list_field("columns", "Stacks of vertices, which neighboring bundles share", &MeshText::columns, column_fields())
          .required(),
      Field<MeshText>{
          "bundles",
          {{"description", "The hair between four columns"}, {"type", "array"}, {"items", object_schema(bundle_fields())}},
          [](const JsonValue& v, MeshText& out) {
            for (const JsonValue& b : v.elements()) read_object(b, bundle_fields(), out.mesh.bundles.emplace_back());
          }}
          .required(),
  };
  return table;
}

// Appends the arrays of each column; what one column has, all must have, a value for each of its vertices.
class Joiner {
 public:
  Joiner(const std::string& name, const std::vector<ColumnText>& columns, HairMesh& mesh) : name_(name), columns_(columns) {
    if (columns.empty()) throw Error(name, "/columns", "no columns", "a bundle stands between four of them");
    mesh.column_offsets = {0};
    for (const ColumnText& column : columns)
      mesh.column_offsets.push_back(mesh.column_offsets.back() + static_cast<std::uint32_t>(column.positions.size()));
    join("positions", &ColumnText::positions, mesh.positions);
    join("tangents", &ColumnText::tangents, mesh.tangents);
    join("uvw", &ColumnText::uvw, mesh.uvw);
    join("occlusion", &ColumnText::occlusion, mesh.occlusion);
  }

 private:
  template <class T>
  void join(const char* key, std::vector<T> ColumnText::*member, std::vector<T>& all) const {
    const bool absent = (columns_[0].*member).empty();
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::vector<T>& values = columns_[c].*member;
      const std::size_t expected = absent ? 0 : columns_[c].positions.size();
      if (values.size() != expected)
        throw Error(name_, fmt::format("/columns/{}/{}", c, key),
                    fmt::format("{} of them where {} are expected", values.size(), expected),
                    "one for each vertex of the column, in all columns or in none");
      all.insert(all.end(), values.begin(), values.end());
    }
  }

  const std::string& name_;
  const std::vector<ColumnText>& columns_;
};

// The shortest text that reads back as the same float.
class TextWriter {
 public:
  explicit TextWriter(const HairMesh& mesh) : mesh_(mesh) {
    put("{{\n  \"hair_mesh\": {},\n", kVersion);
    if (!mesh.comment.empty()) put("  \"comment\": {},\n", quoted(mesh.comment));
    put("  \"width\": {},\n  \"styles\": [", mesh.width);
    each(mesh.styles, [&](const auto& style) { put_style(style); });
    put("\n  ],\n  \"columns\": [");
    for (std::size_t c = 0; c < mesh.column_count(); ++c) put_column(c);
    put("\n  ],\n  \"bundles\": [");
    each(mesh.bundles, [&](const HairMesh::Bundle& b) {
      put("\n    {{\"columns\": [{}], \"strands\": {}, \"style\": {}, \"seed\": {}}}", fmt::join(b.columns, ", "), b.strands,
          b.style, b.seed);
    });
    put("\n  ]\n}}\n");
  }
  std::string_view text() const { return {text_.data(), text_.size()}; }

 private:
  template <class... Arguments>
  void put(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }
  template <class Items, class Put>
  void each(const Items& items, const Put& put_item) {
    bool first = true;
    for (const auto& item : items) {
      if (!first) put(",");
      first = false;
      put_item(item);
    }
  }
  static std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }
  void put_style(const std::vector<StyleOperator>& style) {
    put("\n    [");
    each(style, [&](const StyleOperator& o) {
      put("\n      {{\"kind\": \"{}\", \"amount\": {}, \"frequency\": {}, \"start\": {}, \"variation\": {}}}",
          style_operator_names()[static_cast<std::size_t>(o.kind)], o.amount, o.frequency, o.start, o.variation);
    });
    put("]");
  }
  void put_column(std::size_t c) {
    put("{}\n    {{", c == 0 ? "" : ",");
    put_vectors("positions", mesh_.positions, c);
    put(",\n     ");
    if (!mesh_.tangents.empty()) put_vectors("tangents", mesh_.tangents, c), put(",\n     ");
    put_vectors("uvw", mesh_.uvw, c);
    if (!mesh_.occlusion.empty()) {
      const auto begin = mesh_.occlusion.begin();
      put(",\n     \"occlusion\": [{}]", fmt::join(begin + mesh_.column_offsets[c], begin + mesh_.column_offsets[c + 1], ", "));
    }
    put("}}");
  }
  void put_vectors(const char* key, const std::vector<Vec3>& vectors, std::size_t c) {
    put("\"{}\": [", key);
    for (std::uint32_t i = mesh_.column_offsets[c]; i < mesh_.column_offsets[c + 1]; ++i)
      put("{}[{}, {}, {}]", i == mesh_.column_offsets[c] ? "" : ", ", vectors[i].x, vectors[i].y, vectors[i].z);
    put("]");
  }

  const HairMesh& mesh_;
  fmt::memory_buffer text_;
};

}  // namespace

HairMesh read_hair_mesh_text(const ByteSource& source) {
  constexpr std::uint64_t kMostBytes = 64u << 20;
  if (source.size() > kMostBytes) throw Error(source.name(), "", "more than 64 MiB of JSON", "write it as .hairmesh");
  const JsonDocument document(source.name(), source.read_all(), "a hair mesh is JSON; see docs/hair_mesh.schema.json");
  MeshText text;
  read_object(JsonValue(document), mesh_fields(), text);
  const Joiner join(source.name(), text.columns, text.mesh);
  return std::move(text.mesh);
}

void write_hair_mesh_text(AtomicFile& file, const HairMesh& mesh) { file.write(TextWriter(mesh).text()); }

std::string hair_mesh_schema() {
  Schema schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"title", "Pelage hair mesh"},
                {"description", "Lengths in meters, Y up. Made by `pelage grow --hair-mesh-schema`."}};
  schema.update(object_schema(mesh_fields()));
  return schema.dump(2) + "\n";
}

}  // namespace pelage::io
