// The public entry points for meshes.
#include <pelage/error.h>
#include <pelage/io.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "io/mesh_formats.h"

namespace pelage {

namespace io {
namespace {

void check_mesh(const TriangleMesh& mesh, const std::string& name) {
  const char* const remedy = "the file is damaged; export it again";
  if (mesh.triangles.empty()) throw Error(name, "", "a mesh without triangles", "export the mesh with its faces");
  const auto usable = [](float x) { return std::fabs(x) <= 1e15f; };
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vec3 p = mesh.positions[i];
    if (!usable(p.x) || !usable(p.y) || !usable(p.z))
      throw Error(name, fmt::format("vertex {}", i), "a position that is not finite", remedy);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::uint32_t v : mesh.triangles[t])
      if (v >= mesh.positions.size())
        throw Error(name, fmt::format("triangle {}", t), fmt::format("vertex {} of {}", v, mesh.positions.size()), remedy);
}

// For each vertex, one vertex of those at the same place that stands for all of them.
std::vector<std::uint32_t> weld(const std::vector<Vec3>& positions) {
  std::vector<std::uint32_t> order(positions.size()), leader(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z, i); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < order.size(); ++i)
    leader[order[i]] = i > 0 && positions[order[i]] == positions[order[i - 1]] ? leader[order[i - 1]] : order[i];
  return leader;
}

float angle_between(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

bool is_unit(Vec3 n) {
  const float square = dot(n, n);
  return square > 0.99f && square < 1.01f;
}

}  // namespace

void complete_normals(TriangleMesh& mesh) {
  mesh.normals.resize(mesh.positions.size());
  for (Vec3& n : mesh.normals) n = normalize(n);
  if (std::all_of(mesh.normals.begin(), mesh.normals.end(), is_unit)) return;

  const std::vector<std::uint32_t> leader = weld(mesh.positions);
  std::vector<Vec3> sum(mesh.positions.size());
  for (const std::array<std::uint32_t, 3>& t : mesh.triangles) {
    const Vec3 p[3] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
    const Vec3 face = normalize(cross(p[1] - p[0], p[2] - p[0]));
    if (!is_unit(face)) continue;
    for (int c = 0; c < 3; ++c) sum[leader[t[c]]] += face * angle_between(p[(c + 1) % 3] - p[c], p[(c + 2) % 3] - p[c]);
  }
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    if (is_unit(mesh.normals[i])) continue;
    const Vec3 mean = normalize(sum[leader[i]]);
    mesh.normals[i] = is_unit(mean) ? mean : Vec3(0, 1, 0);  // of no face with an area
  }
}

std::string detect_mesh_format(const ByteSource& source) {
  std::string head(std::min<std::uint64_t>(256, source.size()), '\0');
  source.read(0, head.size(), head.data(), "magic");
  if (head.starts_with("glTF")) return "glb";
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return "ply";
  return looks_like_tfxmesh(head) ? "tfxmesh" : "obj";
}

TriangleMesh read_mesh(const ByteSource& source) {
  if (source.size() == 0) throw Error(source.name(), "", "an empty file", "export the mesh again");
  const std::string format = detect_mesh_format(source);
  TriangleMesh mesh = format == "glb"       ? read_glb(source)
                      : format == "ply"     ? read_ply(source)
                      : format == "tfxmesh" ? read_tfxmesh(source)
                                            : read_obj(source);
  check_mesh(mesh, source.name());
  complete_normals(mesh);
  for (Vec2& uv : mesh.uv)
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {};
  return mesh;
}

}  // namespace io

TriangleMesh read_mesh(const std::string& path, float scale, UpAxis up) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw Error("scale", fmt::format("{}", scale), "not a positive number", "give metres per file unit, e.g. 0.01");
  TriangleMesh mesh = io::read_mesh(io::ByteSource::open(path));
  const auto turned = [&](Vec3 v) { return up == UpAxis::kZ ? Vec3(v.x, v.z, -v.y) : v; };
  for (Vec3& p : mesh.positions) p = turned(p) * scale;
  for (Vec3& n : mesh.normals) n = turned(n);
  return mesh;
}

void write_mesh(const std::string& path, const TriangleMesh& mesh) {
  const bool ply = path.ends_with(".ply") || path.ends_with(".PLY");
  if (!ply && !path.ends_with(".obj") && !path.ends_with(".OBJ"))
    throw Error(path, "", "the extension names no mesh format that is written", "write .obj or .ply");
  io::AtomicFile file(path);
  (ply ? io::write_ply : io::write_obj)(file, mesh);
  file.commit();
}

}  // namespace pelage
