// One entry per reader: what the fuzz targets and the replay of their findings (tests/regress) both call.
#pragma once

#include <pelage/error.h>
#include <pelage/io.h>

#include <span>
#include <string_view>

#include "io/mesh_formats.h"
#include "io/strand_registry.h"

namespace pelage::fuzz {

/// Any groom: the result must satisfy validate() and have strands, or an Error must have said why not.
inline void read_groom(std::span<const std::byte> bytes) {
  try {
    const StrandSet set = io::read_strands(io::ByteSource("fuzz", bytes), {}, nullptr);
    if (set.strand_count() == 0) std::abort();
    try {
      validate(set, "fuzz");
    } catch (const Error&) {
      std::abort();  // the reader's promise is broken
    }
  } catch (const Error&) {
  }
}

inline void read_mesh(std::span<const std::byte> bytes) {
  try {
    const TriangleMesh mesh = io::read_mesh(io::ByteSource("fuzz", bytes));
    if (mesh.triangles.empty() || mesh.normals.size() != mesh.positions.size()) std::abort();
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle)
        if (v >= mesh.positions.size()) std::abort();
  } catch (const Error&) {
  }
}

/// Calls the reader for a corpus file named `<reader>-<anything>`.
inline void replay(std::string_view name, std::span<const std::byte> bytes) {
  if (name.starts_with("mesh"))
    read_mesh(bytes);
  else
    read_groom(bytes);
}

}  // namespace pelage::fuzz
