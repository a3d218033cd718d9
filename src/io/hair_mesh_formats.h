// The two files that hold a hair mesh: binary to ship, text to write by hand. Byte for byte in docs/formats.md.
#pragma once

#include <pelage/hair_mesh.h>
#include <pelage/io.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/atomic_file.h"
#include "io/byte_source.h"
#include "io/scene_json.h"

namespace pelage::io {

/// Whether the bytes begin as a hair mesh does: binary, or a JSON object whose first key is `hair_mesh`.
enum class HairMeshFile { kNone, kBinary, kText };
HairMeshFile hair_mesh_file(const ByteSource& source);

/// What read_strands() expands of a hair mesh: a few kilobytes can ask for more strands than any memory holds.
inline constexpr std::uint64_t kMostStrandsOfHairMesh = 4000000;

/// Sizes are checked against the source before anything is allocated; throws Error naming the byte, line or key. What is
/// returned satisfies validate().
HairMesh read_hair_mesh(const ByteSource& source);
HairMesh read_hair_mesh_binary(const ByteSource& source);
HairMesh read_hair_mesh_text(const ByteSource& source);

/// `mesh` satisfies validate(). The caller commits the file.
void write_hair_mesh_binary(AtomicFile& file, const HairMesh& mesh, const HairMeshPrecision& precision);
void write_hair_mesh_text(AtomicFile& file, const HairMesh& mesh);

/// XXH64 of all bytes of a binary file but the checksum itself; `bytes` are no fewer than its header (56).
std::uint64_t hair_mesh_checksum(std::string_view bytes);

/// The JSON schema of the text file, from the table that reads it: docs/hair_mesh.schema.json.
std::string hair_mesh_schema();

}  // namespace pelage::io
