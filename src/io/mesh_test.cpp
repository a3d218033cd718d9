#include <gtest/gtest.h>
#include <pelage/error.h>
#include <pelage/io.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

#include "io/mesh_formats.h"
#include "kit/io_kit.h"

namespace pelage::io {
namespace {

using kit::TemporaryFolder;
using Triangle = std::array<std::uint32_t, 3>;

TriangleMesh read_bytes(const std::string& bytes) { return read_mesh(ByteSource("mesh", std::as_bytes(std::span(bytes)))); }

std::string error_of(const std::string& bytes) {
  return kit::error_of([&] { read_bytes(bytes); });
}

template <class T>
std::string raw(std::initializer_list<T> values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), std::data(values), bytes.size());
  return bytes;
}

// A unit cube without normals, of quads.
const char* const kCube =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

TEST(ObjMesh, PolygonsBecomeFans) {
  const TriangleMesh mesh = read_bytes("v 0 0 0\nv 1 0 0\nv 1 1 0\nv .5 2 0\nv 0 1 0\nf 1 2 3 4 5\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_TRUE(mesh.uv.empty());
}

TEST(ObjMesh, NegativeIndicesCountBackwards) {
  const TriangleMesh mesh = read_bytes("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions[mesh.triangles[0][1]], Vec3(1, 0, 0));
}

TEST(ObjMesh, CornersThatDifferInUvOrNormalAreDifferentVertices) {
  const TriangleMesh mesh = read_bytes(
      "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 1 1 0\r\nvt 0 0\r\nvt 1 0\r\nvt .5 1 0\r\nvn 0 0 2\r\n"
      "f 1/1/1 2/2/1 3/3/1\r\nf 2/1/1 4/2/1 3/3/1\r\n");
  EXPECT_EQ(mesh.positions.size(), 5u) << "vertex 2 twice, vertex 3 once";
  EXPECT_EQ(mesh.uv[2], Vec2(0.5f, 1));
  for (const Vec3 n : mesh.normals) EXPECT_EQ(n, Vec3(0, 0, 1)) << "made unit";
}

TEST(ObjMesh, FormsOfCornersAndUnknownLines) {
  const std::string head = "# a comment\nmtllib x\no name\nv 0 0 0 1\nv\t1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ns off\nusemtl m\n";
  for (const char* face : {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1 "})
    EXPECT_EQ(read_bytes(head + face).triangles.size(), 1u) << face;
}

TEST(ObjMesh, ErrorsNameTheLine) {
  const std::string head = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_NE(error_of(head + "f 1 2 4\n").find("line 4: vertex 4 of 3"), std::string::npos);
  EXPECT_NE(error_of(head + "f 1 2 0\n").find("vertex 0 of 3"), std::string::npos);
  EXPECT_NE(error_of(head + "f 1 2 -4\n").find("vertex -4 of 3"), std::string::npos);
  EXPECT_NE(error_of(head + "f 1 2\n").find("a face of 2 corners"), std::string::npos);
  EXPECT_NE(error_of(head + "f 1 2 x\n").find("'x' is no index"), std::string::npos);
  EXPECT_NE(error_of(head + "f 1/1 2 3\n").find("texture coordinate 1 of 0"), std::string::npos);
  EXPECT_NE(error_of("v 0 0 nan\n").find("line 1"), std::string::npos);
  EXPECT_NE(error_of("v 0 0\n").find("line 1: '' is no number"), std::string::npos);
  EXPECT_NE(error_of(head).find("no faces"), std::string::npos);
  EXPECT_NE(error_of(std::string("v 0\0 0\n", 8)).find("binary data"), std::string::npos);
  EXPECT_NE(error_of("").find("an empty file"), std::string::npos);
}

TEST(Mesh, MissingNormalsAreWeightedByAngleAndSharedByPosition) {
  const TriangleMesh cube = read_bytes(kCube);
  ASSERT_EQ(cube.normals.size(), 8u);
  // By symmetry each corner's normal is a diagonal, whichever way its quads were cut.
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 diagonal = normalize(cube.positions[i] - Vec3(0.5f, 0.5f, 0.5f));
    EXPECT_GT(dot(cube.normals[i], diagonal), 1 - 1e-6f) << i;
  }
}

TEST(Mesh, GivenNormalsStayWhereOthersAreMissing) {
  TriangleMesh mesh = read_bytes(kCube);
  mesh.normals[3] = {};
  mesh.normals[4] = {0, 0, 1};
  const Vec3 kept = mesh.normals[0];
  complete_normals(mesh);
  EXPECT_LT(length(mesh.normals[0] - kept), 1e-6f);
  EXPECT_EQ(mesh.normals[4], Vec3(0, 0, 1));
  EXPECT_GT(dot(mesh.normals[3], normalize(mesh.positions[3] - Vec3(0.5f, 0.5f, 0.5f))), 1 - 1e-6f);
}

TEST(Mesh, ScaleAndUpAxis) {
  const TemporaryFolder folder;
  kit::spill(folder / "a.obj", "v 1 2 3\nv 2 2 3\nv 1 3 3\nf 1 2 3\n");
  const TriangleMesh mesh = pelage::read_mesh(folder / "a.obj", 0.01f, UpAxis::kZ);
  EXPECT_EQ(mesh.positions[0], Vec3(1, 3, -2) * 0.01f);
  EXPECT_EQ(mesh.normals[0], Vec3(0, 1, 0)) << "+Z of the file is up";
  EXPECT_THROW(pelage::read_mesh(folder / "a.obj", 0), Error);
  EXPECT_THROW(pelage::read_mesh(folder / "absent.obj"), Error);
  EXPECT_THROW(pelage::read_mesh(folder.path()), Error);
}

TEST(Mesh, WritersAndReadersAgree) {
  const TemporaryFolder folder;
  TriangleMesh mesh = read_bytes(kCube);
  for (const bool uv : {false, true}) {
    if (uv)
      for (const Vec3 p : mesh.positions) mesh.uv.emplace_back(p.x / 3, 0.1f * p.y);
    for (const std::string name : {"a.obj", "a.ply"}) {
      write_mesh(folder / name, mesh);
      const TriangleMesh back = pelage::read_mesh(folder / name);
      ASSERT_EQ(back.triangles.size(), mesh.triangles.size()) << name;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
          const std::uint32_t a = back.triangles[t][c], b = mesh.triangles[t][c];
          EXPECT_EQ(back.positions[a], mesh.positions[b]);
          EXPECT_LT(length(back.normals[a] - mesh.normals[b]), 1e-6f);
          if (uv) {
            EXPECT_EQ(back.uv[a], mesh.uv[b]);
          }
        }
    }
  }
  EXPECT_THROW(write_mesh(folder / "a.stl", mesh), Error);
  EXPECT_THROW(write_mesh(folder / "absent/a.ply", mesh), Error);
  EXPECT_EQ(folder.entries(), 2u);
}

const std::string kPlyHead =
    "comment hand-made\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\n"
    "property list uchar int extra\nelement edge 1\nproperty int a\n"
    "element face 1\nproperty uchar flags\nproperty list uchar ushort vertex_indices\nend_header\n";

TEST(PlyMesh, AsciiWithListsAndUnknownElements) {
  const TriangleMesh mesh =
      read_bytes("ply\nformat ascii 1.0\n" + kPlyHead + "0 0 0 0\n1 0 0 2 7 7\n0 1e0 0 1 9\n5\n1 3 0 1 2\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(mesh.positions[2], Vec3(0, 1, 0));
}

// The same mesh with its bytes in either order.
std::string binary_ply(bool big) {
  std::string body;
  const auto put = [&](auto value) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (big) std::reverse(bytes.begin(), bytes.end());
    body += bytes;
  };
  const auto vertex = [&](float x, double y, std::int16_t z, std::uint8_t extra) {
    put(x), put(y), put(z), put(extra);
    for (std::int32_t i = 0; i < extra; ++i) put(i);
  };
  vertex(0, 0, 0, 0), vertex(1, 0, 0, 2), vertex(0, 1, -300, 1);
  put(std::int32_t{5});
  put(std::uint8_t{1}), put(std::uint8_t{3});
  for (const std::uint16_t i : {0, 1, 2}) put(i);
  return std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0\n" + kPlyHead + body;
}

TEST(PlyMesh, BinaryInBothOrders) {
  for (const bool big : {false, true}) {
    const TriangleMesh mesh = read_bytes(binary_ply(big));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
    EXPECT_EQ(mesh.positions[2], Vec3(0, 1, -300));
  }
}

TEST(PlyMesh, ErrorsAndTruncation) {
  const std::string whole = binary_ply(false);
  for (std::size_t n = 0; n < whole.size(); ++n) ASSERT_NE(error_of(whole.substr(0, n)), "") << n;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string bytes = whole;
    return error_of(bytes.replace(bytes.find(from), from.size(), to));
  };
  EXPECT_NE(with("vertex 3", "vertex 4000000000").find("4000000000 of element 'vertex' announced"), std::string::npos);
  EXPECT_NE(with("element edge 1", "element edge 99999999999999").find("announced"), std::string::npos);
  EXPECT_NE(with("float x", "quad x").find("unknown property type"), std::string::npos);
  EXPECT_NE(with("binary_little", "binary_middle").find("unknown format"), std::string::npos);
  EXPECT_NE(with("property float x", "property float q").find("without x, y and z"), std::string::npos);
}

// One triangle under two nodes: scaled, turned and shifted; and mirrored, so that its winding must turn.
std::string glb(const std::string& nodes, const std::string& indices = "", bool short_uv = false) {
  std::string binary = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw<std::uint16_t>({0, 65535, 65535, 0, 0, 0}) + indices;
  std::string json = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
                     R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1})" +
                     (indices.empty() ? "" : R"(,"indices":2)") + R"(}]}],"accessors":[
        {"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
        {"bufferView":1,"componentType":5123,"normalized":true,"count":)" +
                     (short_uv ? "4" : "3") + R"(,"type":"VEC2"},
        {"bufferView":2,"componentType":)" +
                     (indices.size() == 3   ? "5121"
                      : indices.size() == 6 ? "5123"
                                            : "5125") +
                     R"(,"count":3,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},
        {"buffer":0,"byteOffset":48,"byteLength":)" +
                     std::to_string(indices.size()) + R"(}],"buffers":[{"byteLength":)" + std::to_string(binary.size()) + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const auto u = [](std::size_t value) { return raw<std::uint32_t>({static_cast<std::uint32_t>(value)}); };
  const std::string chunks = u(json.size()) + "JSON" + json + u(binary.size()) + std::string("BIN\0", 4) + binary;
  return "glTF" + u(2) + u(12 + chunks.size()) + chunks;
}
const char* const kPlainNode = R"([{"mesh":0}])";

TEST(GlbMesh, IndicesOfEveryWidthAndNone) {
  for (const std::string& indices :
       {std::string(), raw<std::uint8_t>({2, 0, 1}), raw<std::uint16_t>({2, 0, 1}), raw<std::uint32_t>({2, 0, 1})}) {
    const TriangleMesh mesh = read_bytes(glb(kPlainNode, indices));
    ASSERT_EQ(mesh.triangles.size(), 1u);
    EXPECT_EQ(mesh.triangles[0], indices.empty() ? (Triangle{0, 1, 2}) : (Triangle{2, 0, 1}));
    EXPECT_EQ(mesh.uv[0], Vec2(0, 0)) << "normalized, and its origin moved to the bottom";
    EXPECT_EQ(mesh.uv[1], Vec2(1, 1));
    EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  }
}

TEST(GlbMesh, NodesTransform) {
  // Parent: shift; child: quarter turn about z (x → y), then scale 2.
  const TriangleMesh mesh = read_bytes(glb(
      R"([{"translation":[10,0,0],"children":[1]},{"mesh":0,"scale":[2,2,2],"rotation":[0,0,0.70710678118,0.70710678118]}])"));
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_LT(length(mesh.positions[0] - Vec3(10, 0, 0)), 1e-5f);
  EXPECT_LT(length(mesh.positions[1] - Vec3(10, 2, 0)), 1e-5f);
  EXPECT_LT(length(mesh.positions[2] - Vec3(8, 0, 0)), 1e-5f);
}

TEST(GlbMesh, AMatrixThatMirrorsTurnsTheWinding) {
  const TriangleMesh mesh = read_bytes(glb(R"([{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]}])"));
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 2, 1}));
  EXPECT_EQ(mesh.positions[1], Vec3(-1, 0, 5));
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
}

TEST(GlbMesh, Errors) {
  const std::string whole = glb(kPlainNode, raw<std::uint16_t>({2, 0, 1}));
  for (std::size_t n = 0; n < whole.size(); ++n) ASSERT_NE(error_of(whole.substr(0, n)), "") << n;
  EXPECT_NE(error_of(glb(kPlainNode, raw<std::uint16_t>({2, 0, 3}))).find("vertex index 3 of 3"), std::string::npos);
  EXPECT_NE(error_of(glb(kPlainNode, "", true)).find("4 items do not fit"), std::string::npos);
  EXPECT_NE(error_of(glb(R"([{"children":[0]}])")), "") << "a circle";
  EXPECT_NE(error_of(glb(R"([{"children":[1,1]},{"mesh":0}])")).find("a child of two nodes"), std::string::npos);
  EXPECT_NE(error_of(glb(R"([{"children":[7]}])")).find("child 7 does not exist"), std::string::npos);
  EXPECT_NE(error_of(glb(R"([{"mesh":3}])")).find("number 3 of 1"), std::string::npos);
  EXPECT_NE(error_of(glb(R"([{"mesh":-1}])")).find("where a count or index belongs"), std::string::npos);
  EXPECT_NE(error_of(glb(R"([{"mesh":0,"scale":"big"}])")).find("JSON chunk"), std::string::npos);
  EXPECT_NE(error_of(glb(R"([])")), "");
}

constexpr char kTfxMesh[] =
    "# two bones, a triangle\n"
    "numOfBones 2\n# index, name\n0 root\n1 head\n"
    "numOfVertices 3\n"
    "0 0 0 0 0 0 1 0 1 0 0 1 0 0 0\n"
    "1 1 0 0 0 0 1 0 1 0 0 1 0 0 0\r\n"
    "2 0 1e0 0 0 0 1 0 1 0 0 1 0 0 0\n"
    "\nnumOfTriangles 1\n# index, vertices\n0 0 1 2\n";

TEST(TfxMesh, PositionsNormalsAndTriangles) {
  const TriangleMesh mesh = read_bytes(kTfxMesh);
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.positions[2], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.normals[1], Vec3(0, 0, 1));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
}

TEST(TfxMesh, ErrorsAndTruncation) {
  const std::string whole = kTfxMesh;
  const std::size_t last_vertex = whole.size() - 2;  // without its end of line the file is whole
  for (std::size_t n = 0; n < last_vertex; ++n) ASSERT_NE(error_of(whole.substr(0, n)), "") << n;
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string text = whole;
    text.replace(text.find(what), what.size(), instead);
    return error_of(text);
  };
  EXPECT_NE(with("0 0 1 2", "0 0 1 3").find("line 13: '3' is none of the 3 vertices"), std::string::npos)
      << with("0 0 1 2", "0 0 1 3");
  EXPECT_NE(with("numOfVertices 3", "numOfVertices 4000000000").find("more than the rest of the file"), std::string::npos);
  EXPECT_NE(with("1 1 0 0", "2 1 0 0").find("row 1 is due"), std::string::npos);
  EXPECT_NE(with("1e0", "1e99").find("'1e99' is no number"), std::string::npos);
  EXPECT_NE(with("numOfTriangles 1", "numOfTriangles 0"), "");
}

}  // namespace
}  // namespace pelage::io
