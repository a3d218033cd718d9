// OBJ (text, shortest exact numbers) and PLY (binary little-endian) out.
#include <fmt/format.h>

#include "io/mesh_formats.h"

namespace pelage::io {

void write_obj(AtomicFile& file, const TriangleMesh& mesh) {
  file.write("# Pelage; meters, Y up\n");
  for (const Vec3 p : mesh.positions) file.write(fmt::format("v {} {} {}\n", p.x, p.y, p.z));
  for (const Vec2 uv : mesh.uv) file.write(fmt::format("vt {} {}\n", uv.x, uv.y));
  for (const Vec3 n : mesh.normals) file.write(fmt::format("vn {} {} {}\n", n.x, n.y, n.z));
  const auto corner = [&](std::uint32_t v) {
    const std::uint32_t i = v + 1;
    if (mesh.uv.empty()) return mesh.normals.empty() ? fmt::format(" {}", i) : fmt::format(" {0}//{0}", i);
    return mesh.normals.empty() ? fmt::format(" {0}/{0}", i) : fmt::format(" {0}/{0}/{0}", i);
  };
  for (const auto& t : mesh.triangles) file.write(fmt::format("f{}{}{}\n", corner(t[0]), corner(t[1]), corner(t[2])));
}

void write_ply(AtomicFile& file, const TriangleMesh& mesh) {
  file.write(
      fmt::format("ply\nformat binary_little_endian 1.0\ncomment Pelage; meters, Y up\nelement vertex {}\n"
                  "property float x\nproperty float y\nproperty float z\n",
                  mesh.positions.size()));
  if (!mesh.normals.empty()) file.write("property float nx\nproperty float ny\nproperty float nz\n");
  if (!mesh.uv.empty()) file.write("property float u\nproperty float v\n");
  file.write(fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", mesh.triangles.size()));
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    file.put(mesh.positions[i]);
    if (!mesh.normals.empty()) file.put(mesh.normals[i]);
    if (!mesh.uv.empty()) file.put(mesh.uv[i]);
  }
  for (const auto& t : mesh.triangles) {
    file.put(std::uint8_t{3});
    file.put(t);
  }
}

}  // namespace pelage::io
