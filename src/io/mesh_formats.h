// What the mesh readers share. Each leaves normals zero where the file has none; read_mesh() completes them.
#pragma once

#include <pelage/triangle_mesh.h>

#include <string>
#include <string_view>

#include "io/atomic_file.h"
#include "io/byte_source.h"

namespace pelage::io {

TriangleMesh read_obj(const ByteSource& source);
TriangleMesh read_ply(const ByteSource& source);
TriangleMesh read_glb(const ByteSource& source);
TriangleMesh read_tfxmesh(const ByteSource& source);

void write_obj(AtomicFile& file, const TriangleMesh& mesh);
void write_ply(AtomicFile& file, const TriangleMesh& mesh);

/// What read_mesh() does with bytes that are already in memory (tests, fuzzing): detects, reads, checks, completes normals.
TriangleMesh read_mesh(const ByteSource& source);

/// Whether the text that begins with `head` is a TressFX collision mesh.
bool looks_like_tfxmesh(std::string_view head);

/// "obj", "ply", "glb" or "tfxmesh" by content; other text without a magic number counts as OBJ.
std::string detect_mesh_format(const ByteSource& source);

/// Unit normals for the vertices that have none: the mean of the faces' normals around the position, weighted by the angle
/// at the corner (Thürmer and Wüthrich 1998; references.bib: Thurmer1998Normals). Vertices at the same place share it.
void complete_normals(TriangleMesh& mesh);

}  // namespace pelage::io
