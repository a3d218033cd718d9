// The public entry points for meshes.
#include <pelage/error.h>
#include <pelage/io.h>

#include <fmt/format.h>

#include <cmath>

#include "io/mesh_formats.h"

namespace pelage {

TriangleMesh read_mesh(const std::string& path, float scale, UpAxis up) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw Error("scale", fmt::format("{}", scale), "not a positive number", "give metres per file unit, e.g. 0.01");
  const io::ByteSource source = io::ByteSource::open(path);
  if (source.size() == 0) throw Error(path, "", "an empty file", "export the mesh again");
  TriangleMesh mesh = io::read_obj(source);
  const auto turned = [&](Vec3 v) { return up == UpAxis::kZ ? Vec3(v.x, v.z, -v.y) : v; };
  for (Vec3& p : mesh.positions) p = turned(p) * scale;
  for (Vec3& n : mesh.normals) n = turned(n);
  return mesh;
}

Bounds bounds(const TriangleMesh& mesh) {
  Bounds b;
  for (const Vec3 p : mesh.positions) b.extend(p);
  return b;
}

}  // namespace pelage
